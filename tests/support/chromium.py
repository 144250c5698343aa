"""A real Chromium without a display, driven over the DevTools protocol on a pipe: no port, no library."""

import base64
import json
import os
import select
import shutil
import subprocess
import time

LIMIT_S = 60


class Browser:
    """Give it a folder of its own; `close` ends it."""

    def __init__(self, folder, *more):
        to_read, to_browser = os.pipe()
        from_browser, to_write = os.pipe()
        command = ["bash", "-c", f'exec "$@" 3<&{to_read} 4>&{to_write}', "-", "chromium", "--headless=new", "--no-sandbox",
                   "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run", "--disable-background-networking",
                   "--remote-debugging-pipe", f"--user-data-dir={folder}", *more, "about:blank"]
        self.process = subprocess.Popen(command, pass_fds=(to_read, to_write), stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.to_browser, self.from_browser = to_browser, from_browser
        self.heard = b""
        self.asked = 0
        self.events = []

    @staticmethod
    def is_installed():
        return shutil.which("chromium") is not None

    def close(self):
        try:
            self.call("Browser.close")
        except (OSError, EOFError, TimeoutError):
            self.process.kill()
        self.process.wait(timeout=LIMIT_S)
        os.close(self.to_browser)
        os.close(self.from_browser)

    def call(self, method, session=None, **params):
        self.asked += 1
        message = {"id": self.asked, "method": method, "params": params} | ({"sessionId": session} if session else {})
        os.write(self.to_browser, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.next_message()
            if answer.get("id") == self.asked:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def next_message(self):
        end = time.monotonic() + LIMIT_S
        while b"\0" not in self.heard:
            if not select.select([self.from_browser], [], [], end - time.monotonic())[0]:
                raise TimeoutError("the browser says nothing")
            piece = os.read(self.from_browser, 1 << 16)
            if not piece:
                raise EOFError("the browser has ended")
            self.heard += piece
        message, self.heard = self.heard.split(b"\0", 1)
        return json.loads(message)


class Page:
    """A tab of its own."""

    def __init__(self, browser, width=1200, height=800, phone=False):
        self.browser = browser
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2 if phone else 1,
                  mobile=phone)

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def open(self, url):
        return self.call("Page.navigate", url=url)

    def value(self, expression):
        """Of JavaScript in the page; a promise is waited for."""
        done = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in done:
            raise RuntimeError(f"{expression}: {done['exceptionDetails']}")
        return done["result"].get("value")

    def problems(self):
        """Errors that the page has met so far."""
        return [event for event in self.browser.events if event.get("sessionId") == self.session
                and (event["method"] == "Runtime.exceptionThrown"
                     or event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] == "error")]

    def picture(self, path):
        shot = self.call("Page.captureScreenshot", format="png", optimizeForSpeed=False)
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))
