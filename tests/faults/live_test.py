"""Rows of the fault matrix that take the daemon itself: its line, its clock, its processor.

    live_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES [NAME]
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.path += [os.path.join(sys.argv[2], "tests", folder) for folder in ("daemon", "support")]
from support import SOURCES, WORLD, DaemonCase, program, run
from fault_matrix import measured
from host_watch import HostWatch, keep_promise
from spoilt_line import SpoiltLine

PERIOD_S = 0.025  # of the emulated UTM-30LX
HERE = os.path.join(SOURCES, "tests", "faults")


def cpu_s(pid):
    """Of all its threads since it began."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class LiveFaults(DaemonCase):
    def preloaded(self, name):
        library = self.path(name + ".so")
        compiler = shutil.which("cc") or shutil.which("gcc")
        if compiler is None:
            self.skipTest("there is no C compiler")
        subprocess.run([compiler, "-shared", "-fPIC", "-o", library, os.path.join(HERE, name + ".c"), "-ldl"], check=True)
        return library

    def is_ok(self):
        return self.answer("status")[:3] == "OK\n"

    def share_of_cpu(self, daemon, seconds):
        before_s, begin = cpu_s(daemon.pid), time.monotonic()
        time.sleep(seconds)
        return (cpu_s(daemon.pid) - before_s) / (time.monotonic() - begin)

    def start_behind_a_line(self, *more):
        """The robot stands, so that only its surroundings misbehave."""
        laser = self.start("odoless", "emulate", "lrf", "--from", WORLD, "--start-delay-s", 600, "--pty", self.path("device"))
        self.wait_until(lambda: os.path.lexists(self.path("device")), 10)
        line = SpoiltLine(self.path("device"), self.path("laser"))
        self.addCleanup(line.end)
        daemon = self.start_daemon(*more)
        self.wait_until_ok()
        return laser, line, daemon

    def test_rows_2_8_34_and_41_the_line_the_process_and_the_processor(self):
        laser, line, daemon = self.start_behind_a_line("--enforce-realtime")
        self.stops_of_the_process(daemon)
        self.hogs()
        self.garbage(line)
        self.silence_for_ever(laser, daemon)
        self.assertIsNone(daemon.poll())
        self.stop_in_time(daemon)
        summary = self.summary()
        self.assertEqual(summary["heap_calls"], 0)
        with open(self.path("out/latest/trajectory_online.tum"), encoding="utf-8") as file:
            for text in file:
                x_m, y_m = map(float, text.split()[1:3])
                self.assertLess(x_m**2 + y_m**2, 0.05**2, text)  # it never moved

    def stops_of_the_process(self, daemon):
        """Row 34. In the first five seconds no match score is usual yet, and a robot that may have gone far meanwhile is on trial."""
        measured(34, "recover at the start of a run", self.recovery_s(daemon, 2.0), "s")
        time.sleep(5.0)
        for stopped_s in (0.1, 0.5, 2.0):
            measured(34, f"recover of {stopped_s} s", self.recovery_s(daemon, stopped_s), "s")

    def recovery_s(self, daemon, stopped_s):
        """From the end of a stop until the daemon is OK."""
        scans = self.scans_accepted()
        os.kill(daemon.pid, signal.SIGSTOP)
        time.sleep(stopped_s)
        os.kill(daemon.pid, signal.SIGCONT)
        begin = time.monotonic()
        self.wait_until(lambda: self.scans_accepted() > scans, 10)
        time.sleep(0.05)
        self.wait_until(self.is_ok, 10)
        return time.monotonic() - begin

    def scans_accepted(self):
        return self.status_json()["scans"]["accepted"]

    def status_json(self):
        return json.loads(self.answer("status json"))

    def hogs(self):
        """Row 41: four processes that compute, and one that writes to 256 MB again and again."""
        compute, fill = "while True: pass", "b = bytearray(256 << 20)\nwhile True:\n  b[::4096] = bytes(len(b) // 4096)"
        before = self.misses()
        hogs = [subprocess.Popen([sys.executable, "-c", text]) for text in (compute, compute, compute, compute, fill)]
        time.sleep(3.0)
        missed = self.misses() - before
        for hog in hogs:
            hog.kill()
            hog.wait()
        measured(41, "missed", missed, "deadlines")
        begin = time.monotonic()
        scans = self.scans_accepted()
        self.wait_until(lambda: self.scans_accepted() > scans, 2, pause_s=0.001)
        measured(41, "recover", (time.monotonic() - begin) / PERIOD_S, "T")
        self.assertEqual("deadline was missed" in self.state(), missed > 0, "misses are told truthfully")

    def misses(self):
        return sum(stage["deadline_misses"] for stage in self.status_json()["stages"].values())

    def garbage(self, line):
        """Row 8."""
        self.wait_until(self.is_ok, 10)
        before = self.misses()
        line.garbage = True
        flag_s = self.wait_until(lambda: not self.is_ok(), 2, pause_s=0.001) - self.answer_s()
        time.sleep(1.0)
        missed = self.misses() - before
        line.garbage = False
        begin = time.monotonic()
        self.wait_until(self.is_ok, 20)
        measured(8, "flag", flag_s / PERIOD_S, "T")
        measured(8, "missed", missed, "deadlines")
        measured(8, "recover", time.monotonic() - begin, "s")
        self.assertEqual(missed, 0)

    def silence_for_ever(self, laser, daemon):
        """Row 2."""
        self.wait_until(self.is_ok, 10)
        laser.send_signal(signal.SIGSTOP)
        flag_s = self.wait_until(lambda: not self.is_ok(), 2, pause_s=0.001) - self.answer_s()
        time.sleep(1.0)
        share = self.share_of_cpu(daemon, 3.0)
        measured(2, "flag", flag_s / PERIOD_S, "T")
        measured(2, "CPU", 100.0 * share, "%")
        self.assertTrue(self.state().startswith("FAULT"))
        self.assertLess(share, 0.05)
        laser.send_signal(signal.SIGCONT)
        measured(2, "recover", self.wait_until(self.is_ok, 20), "s")

    def test_row_4_reads_of_the_line_that_fail(self):
        with open(self.path("line"), "w", encoding="ascii") as file:
            file.write("-")
        daemon = self.start_daemon_with({"LD_PRELOAD": self.preloaded("line_faults"), "LINE_FAULT": self.path("line")})
        self.wait_until_ok()
        for letter, name in (("I", "EINTR"), ("A", "EAGAIN"), ("E", "EIO")):
            self.fail_reads(letter)
            self.wait_until(lambda: not self.is_ok(), 2)
            share = self.share_of_cpu(daemon, 1.0)
            self.fail_reads("-")
            measured(4, f"CPU with {name}", 100.0 * share, "%")
            measured(4, f"recover of {name}", self.wait_until(self.is_ok, 20), "s")
            self.assertIsNone(daemon.poll())
            self.assertLess(share, 0.3, name)
        self.stop_in_time(daemon)

    def start_daemon_with(self, environment):
        self.start_laser("--start-delay-s", 600)
        return self.start_daemon(environment=environment)

    def fail_reads(self, letter):
        with open(self.path("line"), "r+", encoding="ascii") as file:  # in place: it is mapped
            file.write(letter)

    def test_row_19_the_wall_clock_jumps_by_an_hour(self):
        whole, log = self.path("whole.log"), self.path("part.log")
        self.assertEqual(run("odoless", "sim", WORLD, "--out", whole).returncode, 0)
        with open(whole, encoding="ascii") as file, open(log, "w", encoding="ascii") as part:
            part.writelines(file.readlines()[:150])
        sums = []
        for environment in ({}, {"LD_PRELOAD": self.preloaded("wall_clock")}):
            daemon = self.start_daemon("--replay", log, environment=environment)
            self.assertEqual(daemon.wait(timeout=60), 0)
            said = daemon.stderr.read()
            sums.append(self.summary()["sha256"])
        read = int(said.split("wall clock: read ")[1].split()[0])
        measured(19, "wall clock read", read, "times")
        self.assertGreater(read, 3, "the clock did not jump")
        self.assertEqual(sums[0], sums[1], "the estimate is not the same to the bit")

    def test_row_21_more_scans_than_there_is_time_for(self):
        rate = 20.0  # of 40 Hz: more than two daemons could match
        log = self.path("rooms.log")
        self.assertEqual(run("odoless", "sim", WORLD, "--lrf", "utm-30lx", "--out", log).returncode, 0)
        with open(log, encoding="ascii") as file:
            lasts_s = float(file.read().rstrip().rsplit("\n", 1)[1].split()[-1])
        with HostWatch() as host:
            daemon = self.start_daemon("--replay", log, "--rate", rate)
            self.assertEqual(daemon.wait(timeout=60), 0)
        summary = self.summary()
        late_s = summary["wall_s"] - lasts_s / rate - 0.2 - host.withheld_s
        measured(21, "dropped", 100.0 * summary["scans_dropped"] / summary["scans_accepted"], "% of the scans")
        measured(21, "late", max(0.0, late_s), "s")
        self.assertGreater(summary["scans_dropped"], 0)
        self.assertEqual(summary["scans_accepted"], summary["scans"] + summary["scans_dropped"], "each is counted")
        self.assertIn("scans or records are dropped", summary["latched_reasons"])
        self.assertLess(late_s, 0.7, "scans wait")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
