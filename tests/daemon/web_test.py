"""The page of the daemon in a real Chromium: what it shows, and what a page of somebody else gets.

    web_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES
    web_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES --pictures FOLDER   takes pictures for the README instead
"""

import contextlib
import http.server
import json
import os
import sys
import threading
import time
import unittest

from support import WORLD, poses, run
from host_watch import keep_promise  # found by support
from chromium import Page  # likewise
from web_support import WebCase, get

RED = "rgb(185, 28, 28)"
MOST_BYTES = 300_000  # of the page with all that belongs to it


OCCUPIED, FREE = 0, 254  # greys of a saved map, from 65 % and up to 25 %; all between them, and unknown, is another
LEVELS = {OCCUPIED: range(10, 16), FREE: range(0, 5)}  # what the page has for them
BETWEEN = {*range(4, 11), 16}


def saved_map(folder):
    """Size of a cell, the lower left corner, columns, and the greys of the cells, row by row from the lowest."""
    with open(os.path.join(folder, "map.yaml"), encoding="utf-8") as file:
        said = dict(line.split(":", 1) for line in file if ":" in line)
    with open(os.path.join(folder, "map.pgm"), "rb") as file:
        content = file.read()
    columns, rows = map(int, content.split(maxsplit=3)[1:3])
    cells = content[-columns * rows:]
    greys = [grey for row in range(rows - 1, -1, -1) for grey in cells[row * columns:(row + 1) * columns]]
    return float(said["resolution"]), json.loads(said["origin"])[:2], columns, greys


@contextlib.contextmanager
def elsewhere(html):
    """A server of somebody else, on another port."""
    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(html.encode())

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()
        server.server_close()


class PageTest(WebCase):
    def shows(self, page, expression, seconds=10):
        return self.wait_until(lambda: page.value(expression), seconds, pause_s=0.05)

    def test_shows_map_and_pose_within_two_seconds_and_follows_the_robot(self):
        self.start_robot()
        page = Page(self.browser())

        def time_to_appear():
            page.open("about:blank")
            begin = time.monotonic()
            page.open(self.url)
            self.shows(page, "!!(window.odoless?.pose && odoless.tiles > 0)")
            return time.monotonic() - begin

        keep_promise(self, 2.0, time_to_appear)
        self.shows(page, "document.body.dataset.state === 'OK'", 5)  # where the first updates were cut short, a second later
        self.assertRegex(page.value("document.getElementById('probability').textContent"), r"^pose right: \d+ %$")
        before = page.value("odoless.pose")
        self.shows(page, f"Math.hypot(odoless.pose.x_m - {before['x_m']}, odoless.pose.y_m - {before['y_m']}) > 0.3")
        self.assertGreater(page.value("odoless.path_points"), 2)
        self.assertEqual(page.value("document.getElementById('follow').getAttribute('aria-pressed')"), "true")
        shown, said = page.value("odoless.pose"), self.status()["pose"]
        self.assertLess(abs(shown["x_m"] - said["x_m"]) + abs(shown["y_m"] - said["y_m"]), 1.5 * (said["stamp_s"] - shown["stamp_s"] + 0.2))
        self.assertRegex(page.value("document.getElementById('scans').textContent"), r"^\d+\.\d Hz, poses \d+\.\d Hz, \d+ dropped")
        self.assertEqual(page.problems(), [])

    def test_shows_the_very_map_that_is_saved(self):
        """What is published is the filter's map; with the pose graph on, what is saved would be that of the graph."""
        self.use_page("[graph]\nenabled = false\n")
        _, daemon = self.start_robot()
        page = Page(self.browser())
        page.open(self.url)
        time.sleep(8)
        mapped = page.value("odoless.pose")
        self.assertEqual(self.ctl("pause").stdout, "ok\n")  # then nothing is mapped any more, and the robot moves on
        time.sleep(6)  # and each tile has been sent again (lcm.map_refresh_s)
        self.assertEqual(self.ctl("save").returncode, 0)
        cell_m, (left_m, low_m), columns, greys = saved_map(self.path("out/latest"))
        self.assertGreater(greys.count(OCCUPIED), 100)
        self.assertGreater(greys.count(FREE), 1000)
        levels = page.value(f"Array.from({{length: {len(greys)}}}, (_, i) => odoless.levelAt("
                            f"{left_m} + (i % {columns} + 0.5) * {cell_m}, {low_m} + (Math.floor(i / {columns}) + 0.5) * {cell_m}))")
        wrong = sum(level not in LEVELS.get(grey, BETWEEN) for grey, level in zip(greys, levels))
        self.assertEqual(wrong, 0, f"of {len(greys)} cells")
        self.assertLessEqual(page.value(f"odoless.levelAt({mapped['x_m']}, {mapped['y_m']})"), 4, "the robot stands in a wall")
        self.assertEqual(page.value("odoless.levelAt(1000, 1000)"), 16)
        self.stop_in_time(daemon)

    def test_takes_nothing_from_another_host_and_is_small(self):
        self.start_robot()
        page = Page(self.browser())
        page.open(self.url)
        self.shows(page, "!!window.odoless?.pose")
        asked = page.value("performance.getEntriesByType('resource').map(entry => entry.name)")
        self.assertTrue(asked and all(name.startswith(self.url) or name.startswith("data:") for name in asked), asked)
        self.assertLess(sum(len(get(self.port, path)) for path in ("/", "/page.js", "/page.css")), MOST_BYTES)

    def test_zooms_moves_measures_and_fits_a_phone(self):
        self.start_robot()
        page = Page(self.browser(), width=390, height=780, phone=True)
        page.open(self.url)
        self.shows(page, "!!(window.odoless?.pose && odoless.tiles > 0)")
        self.assertEqual(page.value("document.documentElement.scrollWidth"), 390, "it is wider than the phone")
        before = page.value("odoless.view")
        page.value("document.getElementById('in').click()")
        self.assertAlmostEqual(page.value("odoless.view.px_per_m"), 1.5 * before["px_per_m"])
        for kind, x in (("mousePressed", 100), ("mouseMoved", 160), ("mouseReleased", 160)):
            page.call("Input.dispatchMouseEvent", type=kind, x=x, y=300, button="left", buttons=1, clickCount=1)
        self.assertFalse(page.value("odoless.view.follow"), "who moves the map looks at something else")
        held = page.value("odoless.view")
        time.sleep(1)
        self.assertEqual(page.value("odoless.view"), held, "the map stays where it was put")
        page.value("document.getElementById('measure').click()")
        for x in (100, 100 + held["px_per_m"]):
            for kind in ("mousePressed", "mouseReleased"):
                page.call("Input.dispatchMouseEvent", type=kind, x=x, y=300, button="left", buttons=1, clickCount=1)
        self.assertEqual(page.value("document.getElementById('measured').textContent"), "1.00 m")
        page.value("document.getElementById('follow').click()")
        self.shows(page, "odoless.view.follow && Math.abs(odoless.view.x_m - odoless.pose.x_m) < 0.5")

    def test_turns_red_when_the_laser_is_lost(self):
        laser, _ = self.start_robot()
        page = Page(self.browser())
        page.open(self.url)
        self.shows(page, "document.body?.dataset.state === 'OK'")
        colour = "getComputedStyle(document.querySelector('header')).backgroundColor"
        self.assertNotEqual(page.value(colour), RED)
        self.unplug(laser, "laser")
        self.shows(page, f"{colour} === '{RED}'", 4)
        self.assertEqual(page.value("document.getElementById('state').textContent"), "FAULT")
        self.assertIn("no scans", page.value("document.getElementById('reasons').textContent"))

    def test_goes_on_after_the_daemon_was_restarted(self):
        _, daemon = self.start_robot()
        page = Page(self.browser())
        page.open(self.url)
        self.shows(page, "!!(window.odoless?.pose && odoless.tiles > 0)")
        run_before = page.value("odoless.run")
        self.stop_in_time(daemon)
        self.shows(page, "document.getElementById('state').textContent === 'no connection'", 5)
        self.start_daemon()
        self.shows(page, f"odoless.run !== '{run_before}' && !!odoless.pose && odoless.tiles > 0", 15)
        self.assertEqual(page.value("document.body.dataset.state"), self.status()["state"])

    def test_shows_a_replay_which_gives_the_same(self):
        log = self.path("log.clf")
        self.assertEqual(run("odoless", "sim", WORLD, "--out", log).returncode, 0)
        self.assertEqual(run("odoless", "replay", log, "--every", 2, "--out", self.path("without")).returncode, 0)
        self.start("odoless", "replay", log, "--every", 2, "--out", self.path("with"), "--web", f"127.0.0.1:{self.port}")
        summary = self.path("with/summary.json")
        self.wait_until(lambda: os.path.exists(summary), 60)
        page = Page(self.browser())
        page.open(self.url)
        self.shows(page, "!!(window.odoless?.pose && odoless.tiles > 0)")
        x_m, y_m, _ = list(poses(self.path("with/trajectory_online.tum")).values())[-1]
        self.shows(page, f"Math.hypot(odoless.pose.x_m - {x_m}, odoless.pose.y_m - {y_m}) < 0.01")
        self.assertEqual(poses(self.path("with/trajectory.tum")), poses(self.path("without/trajectory.tum")))

    def test_who_knows_the_token_pauses_saves_and_says_where_the_robot_is(self):
        self.use_token()
        self.start_robot()
        page = Page(self.browser())
        page.open(self.url)
        self.shows(page, "!!window.odoless?.pose && !document.getElementById('control').hidden")
        click = lambda button: page.value(f"document.getElementById('{button}').click()")
        answer = "document.getElementById('answer').textContent"
        click("control")
        click("pause")
        self.shows(page, f"{answer} === 'the token is wrong'")
        page.value(f"document.getElementById('token').value = '{self.token}'")
        click("pause")
        self.shows(page, f"{answer} === 'pause: ok'")
        self.shows(page, "document.getElementById('reasons').textContent.includes('pause')")
        click("resume")
        self.shows(page, f"{answer} === 'resume: ok'")
        self.shows(page, "!document.getElementById('reasons').textContent.includes('pause')")
        click("save")
        self.shows(page, f"{answer}.startsWith('save: ') && !{answer}.includes('error')")
        click("place")
        for kind, x, y in (("mousePressed", 300, 300), ("mouseMoved", 300, 250), ("mouseReleased", 300, 200)):
            page.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)
        self.shows(page, f"/^pose .* 90.00: ok$/.test({answer})")

    # Pages of somebody else

    def test_gives_a_page_of_another_origin_nothing(self):
        self.use_token()
        self.start_robot()
        page = Page(self.browser("--host-resolver-rules=MAP rebound.example 127.0.0.1"))
        with elsewhere("<title>elsewhere</title>") as url:
            page.open(url)
            self.shows(page, "document.title === 'elsewhere'")
            tried = page.value(f"""(async () => {{
                const own = '{self.url}';
                const got = {{}};
                const tell = (name, promise) => promise.then(value => got[name] = value, () => got[name] = 'refused');
                const element = (tag, set) => new Promise((take, refuse) => {{
                  const one = document.createElement(tag);
                  one.onload = () => take('loaded');
                  one.onerror = refuse;
                  set(one);
                  document.body.append(one);
                }});
                const known = {{Authorization: 'Bearer {self.token}'}};  // even who knows the token, as no stranger does
                for (const mode of ['cors', 'no-cors']) {{
                  await tell('command ' + mode, fetch(own + 'command', {{method: 'POST', body: 'pause', mode, headers: known}})
                    .then(response => response.type === 'opaque' ? Promise.reject() : response.text()));
                }}
                const form = document.createElement('form');
                Object.assign(form, {{method: 'POST', action: own + 'command', enctype: 'text/plain', target: 'sent'}});
                document.body.insertAdjacentHTML('beforeend', '<iframe name="sent"></iframe>');
                document.body.append(form);
                form.submit();
                for (const path of ['', 'events', 'page.js', 'control']) {{
                  await tell('fetch ' + path, fetch(own + path).then(response => response.text()));
                  await tell('post ' + path, fetch(own + path, {{method: 'POST', body: 'stop'}}).then(response => response.text()));
                }}
                await tell('stream', new Promise((take, refuse) => {{
                  const stream = new EventSource(own + 'events');
                  stream.onopen = () => take('open');
                  stream.onerror = refuse;
                }}));
                await tell('script', element('script', one => one.src = own + 'page.js'));
                await tell('image', element('img', one => one.src = own + 'events'));
                return got;
            }})()""")
            self.assertEqual(set(tried.values()), {"refused"}, tried)
            page.value(f"document.body.insertAdjacentHTML('beforeend', '<iframe src=\"{self.url}\"></iframe>')")
            frames = lambda: page.call("Page.getFrameTree")["frameTree"].get("childFrames", [])
            self.wait_until(lambda: any("unreachableUrl" in child["frame"] for child in frames()), 5, pause_s=0.1)
        self.assertFalse(any("pause" in reason for reason in self.status()["reasons"]), "a stranger has paused mapping")
        page.open(f"http://rebound.example:{self.port}/")
        time.sleep(1)
        self.assertFalse(page.value("'odoless' in window"), "a name that a stranger let point here")

class Pictures(WebCase):
    """Not a test: pictures of the page on a screen and on a phone."""

    folder_of_pictures = ""

    def test_take_pictures(self):
        self.start_robot()
        browser = self.browser()
        time.sleep(40)
        for name, width, height, phone in (("page_desktop", 1000, 640, False), ("page_phone", 360, 700, True)):
            page = Page(browser, width, height, phone)
            page.open(self.url)
            time.sleep(4)
            page.value("document.getElementById('all').click()")
            time.sleep(1)
            path = os.path.join(self.folder_of_pictures, name + ".png")
            page.picture(path)
            print(f"  {path}: {os.path.getsize(path)} bytes")


if __name__ == "__main__":
    if len(sys.argv) > 4 and sys.argv[3] == "--pictures":
        Pictures.folder_of_pictures = sys.argv[4]
        unittest.main(argv=[sys.argv[0], "Pictures"], verbosity=2)
    else:
        unittest.main(argv=[sys.argv[0], "PageTest"] if len(sys.argv) <= 3 else [sys.argv[0], *sys.argv[3:]], verbosity=2)
