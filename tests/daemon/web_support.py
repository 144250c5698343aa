"""What tests of the page share: a daemon that serves it, and requests as they go over the wire."""

import json
import os
import socket

from support import DaemonCase
from chromium import Browser  # found by support


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def request(port, *lines):
    """A connection that has asked for that."""
    client = socket.create_connection(("127.0.0.1", port), timeout=10)
    client.sendall("\r\n".join([*lines, "", ""]).encode())
    return client


def answer_to(port, *lines):
    with request(port, *lines) as client:
        return client.makefile("rb").read().decode()


def get(port, path="/", host=None, more=()):
    return answer_to(port, f"GET {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", *more)


class WebCase(DaemonCase):
    def setUp(self):
        super().setUp()
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}/"
        self.use_page()

    def use_page(self, more=""):
        self.config = self.write_config("web.toml", f'[web]\nlisten = "127.0.0.1:{self.port}"\n{more}')

    token = "0123456789abcdef"

    def use_token(self):
        path = self.path("token")
        with open(path, "w", encoding="ascii") as file:
            file.write(self.token + "\n")
        os.chmod(path, 0o600)
        self.use_page(f'token_file = "{path}"\n')

    def browser(self, *more):
        if not Browser.is_installed():
            self.skipTest("chromium is not installed (tools/setup installs it)")
        browser = Browser(self.path("profile"), *more)
        self.addCleanup(browser.close)
        return browser

    def start_robot(self, *more):
        laser = self.start_laser(*more)
        daemon = self.start_daemon("--enforce-realtime")
        self.wait_until_ok()
        return laser, daemon

    def status(self):
        return json.loads(self.answer("status json"))
