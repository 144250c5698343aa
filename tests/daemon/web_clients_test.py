"""The page of the daemon without a browser: who is served, how many, and what they cost.

    web_clients_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES
"""

import socket
import sys
import threading
import time
import unittest

from support import run
from host_watch import HostWatch  # found by support
from web_support import WebCase, get, answer_to, request

EX_UNAVAILABLE, EX_CONFIG = 69, 78
MOST_BYTES_PER_S = 200_000


class ClientsTest(WebCase):
    def test_refuses_what_is_not_its_own_page_asking(self):
        self.start_daemon()
        self.wait_until(self.state, 10)
        own = f"127.0.0.1:{self.port}"
        said = []
        for status, lines in ((200, ["GET / HTTP/1.1", f"Host: {own}"]),
                              (200, ["GET / HTTP/1.1", f"Host: localhost:{self.port}"]),
                              (200, ["GET / HTTP/1.1", f"Host: {socket.gethostname()}"]),
                              (200, ["GET / HTTP/1.1", f"Host: {own}", "Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: navigate",
                                     "Sec-Fetch-Dest: document"]),
                              (404, ["GET /etc/passwd HTTP/1.1", f"Host: {own}"]),
                              (421, ["GET / HTTP/1.1", "Host: rebound.example"]),
                              (421, ["GET / HTTP/1.1", f"Host: {own}", "Host: rebound.example"]),
                              (421, ["GET / HTTP/1.1"]),
                              (403, ["GET /events HTTP/1.1", f"Host: {own}", "Origin: http://127.0.0.1:1"]),
                              (403, ["GET /events HTTP/1.1", f"Host: {own}", "Origin: null"]),
                              (403, ["GET /events HTTP/1.1", f"Host: {own}", "Sec-Fetch-Site: cross-site"]),
                              (403, ["GET / HTTP/1.1", f"Host: {own}", "Sec-Fetch-Site: same-site", "Sec-Fetch-Mode: navigate",
                                     "Sec-Fetch-Dest: iframe"]),
                              *((405, [f"{method} / HTTP/1.1", f"Host: {own}", "Content-Length: 0"])
                                for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS", "HEAD"))):
            answer = answer_to(self.port, *lines)
            self.assertEqual(answer.split(" ")[1], str(status), lines)
            said.append(answer.lower())
        self.assertFalse(any("access-control" in answer for answer in said))
        for word in ("default-src 'none'", "x-frame-options: deny", "nosniff"):
            self.assertIn(word, said[0])

    # Many of them

    def test_serves_twenty_at_once_drops_no_scan_and_misses_no_deadline(self):
        self.start_robot()
        seconds = 6
        heard = [0] * 20

        def watch(index):
            with request(self.port, "GET /events HTTP/1.1", f"Host: 127.0.0.1:{self.port}") as client:
                end = time.monotonic() + seconds
                while time.monotonic() < end:
                    heard[index] += len(client.recv(1 << 16))

        def missed(status):
            return sum(status["stages"][stage]["deadline_misses"] for stage in ("sensor", "matcher", "filter"))

        def disturbed():
            before = self.status()
            threads = [threading.Thread(target=watch, args=(index,)) for index in range(len(heard))]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            after = self.status()
            scans, scans_before = after["scans"], before["scans"]
            self.assertGreater(scans["accepted"] - scans_before["accepted"], 20 * seconds)
            return scans["dropped"] - scans_before["dropped"], missed(after) - missed(before)

        with HostWatch() as host:
            dropped, late = disturbed()
        print(f"  {dropped} dropped, {late} deadlines missed; {min(heard) / seconds / 1000:.0f} to {max(heard) / seconds / 1000:.0f} kB/s for each of 20; "
              f"the machine withheld {host.withheld_s:.2f} s")
        self.assertGreater(min(heard), 5000 * seconds)
        self.assertLess(max(heard), MOST_BYTES_PER_S * seconds)
        if dropped + late > 0 and host.withheld_s > 1.0:
            self.skipTest("the machine was too busy to tell whose fault it is")
        self.assertEqual((dropped, late), (0, 0))

    def test_one_that_takes_nothing_costs_nothing_and_is_left(self):
        def resident_bytes():
            with open(f"/proc/{daemon.pid}/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * 4096

        _, daemon = self.start_robot()
        with request(self.port, "GET /events HTTP/1.1", f"Host: 127.0.0.1:{self.port}") as first:
            first.recv(100)  # what the first one costs anyway
        before = resident_bytes()
        stuck = [request(self.port, "GET /events HTTP/1.1", f"Host: 127.0.0.1:{self.port}") for _ in range(10)]
        self.addCleanup(lambda: [one.close() for one in stuck])
        time.sleep(6)
        self.assertLess(resident_bytes() - before, 4 << 20)
        self.stop_in_time_of_writes(daemon)

    def stop_in_time_of_writes(self, daemon):
        begin = time.monotonic()
        daemon.terminate()
        self.assertEqual(daemon.wait(timeout=10), 0, daemon.stderr.read())
        self.assertLess(time.monotonic() - begin, 5.0)

    def test_more_than_may_watch_are_told_so_and_silent_ones_hold_up_nobody(self):
        self.use_page("clients_max = 2\n")
        self.start_robot()
        watching = [request(self.port, "GET /events HTTP/1.1", f"Host: 127.0.0.1:{self.port}") for _ in range(2)]
        self.assertTrue(all(b"200" in one.recv(15) for one in watching))
        self.assertIn("503", get(self.port, "/events").split("\r\n")[0])
        watching.pop().close()
        self.wait_until(lambda: b"200" in watching_again(self, watching), 5)
        silent = [socket.create_connection(("127.0.0.1", self.port)) for _ in range(8)]
        self.addCleanup(lambda: [one.close() for one in silent + watching])
        begin = time.monotonic()
        self.assertIn("200", get(self.port).split("\r\n")[0])
        self.assertLess(time.monotonic() - begin, 6.0)
        self.assertNotEqual(self.state(), "")

    def test_its_memory_is_told_too(self):
        said_mb = float(run("odoless", "memory", self.config).stdout.strip().split("\n")[-1].split()[0])
        _, daemon = self.start_robot()
        streams = [request(self.port, "GET /events HTTP/1.1", f"Host: 127.0.0.1:{self.port}") for _ in range(10)]
        self.addCleanup(lambda: [one.close() for one in streams])
        time.sleep(1)
        with open(f"/proc/{daemon.pid}/status", encoding="utf-8") as file:
            locked_mb = float(next(line for line in file if line.startswith("VmLck")).split()[1]) * 1024e-6
        if locked_mb == 0.0:
            self.skipTest("this machine does not let memory be locked")
        self.assertAlmostEqual(said_mb / locked_mb, 1.0, delta=0.05, msg=f"said {said_mb} MB, locked {locked_mb:.2f} MB")

    # What a start lacks

    def test_says_what_is_wrong_with_its_address(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", self.port))
            other.listen()
            outcome = run("odolessd", "--config", self.config, timeout=10)
        self.assertEqual(outcome.returncode, EX_UNAVAILABLE, outcome.stderr)
        for word in ("web.listen", str(self.port), "in use"):
            self.assertIn(word, outcome.stderr)
        wrong = self.write_config("wrong.toml", '[web]\nlisten = "8080"\n')
        outcome = run("odolessd", "--config", wrong, "--check")
        self.assertEqual(outcome.returncode, EX_CONFIG)
        self.assertIn("127.0.0.1:8080", outcome.stderr)


def watching_again(test, watching):
    client = request(test.port, "GET /events HTTP/1.1", f"Host: 127.0.0.1:{test.port}")
    said = client.recv(15)
    watching.append(client) if b"200" in said else client.close()
    return said


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
