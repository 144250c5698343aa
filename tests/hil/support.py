"""What tests in the guest share: programs of the product, simulated GPIO chips, waiting."""

import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAMS, SOURCES = sys.argv[1:3]
sys.path.append(os.path.join(SOURCES, "tests", "support"))
from host_watch import wait_for  # there
from lcm_log import messages  # there


def program(name, *arguments):
    return [os.path.join(PROGRAMS, name), *map(str, arguments)]


def emulator(*arguments):
    """Above the daemon, whose sensor thread has priority 10: hardware does not wait for the processor that reads it."""
    return ["chrt", "--fifo", "20", *program("odoless", "emulate", *arguments)]


def run(*command, timeout=60):
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)


class HilTest(unittest.TestCase):
    """A folder for each test; programs that it starts end with it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.started = []

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *command, **options):
        options.setdefault("stdout", subprocess.DEVNULL)
        self.started.append(subprocess.Popen(command, text=True, **options))
        self.addCleanup(self.end_all)  # before what it uses goes
        return self.started[-1]

    def end_all(self):
        """Of what was started: the last one first."""
        while self.started:
            self.end(self.started.pop())

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def wait_until(self, holds, seconds, what="it"):
        """Returns after how many seconds it held."""
        waited_s = wait_for(holds, seconds)
        self.assertIsNotNone(waited_s, f"{what} did not happen in {seconds} s")
        return waited_s

    def end_of(self, process, seconds=20):
        """The status of a process that ends by itself."""
        self.wait_until(lambda: process.poll() is not None, seconds, f"the end of {os.path.basename(process.args[0])}")
        return process.returncode


class SimulatedGpio:
    """A chip of gpio-sim. `lines` are names by offset; `level` is what the outside puts on a line, `value` what is on it."""

    CONFIG = "/sys/kernel/config/gpio-sim"

    def __init__(self, name, lines):
        self.folder = os.path.join(self.CONFIG, name)
        bank = os.path.join(self.folder, "bank0")
        os.makedirs(bank)
        self._write(os.path.join(bank, "num_lines"), len(lines))
        for offset, line in enumerate(lines):
            os.mkdir(os.path.join(bank, f"line{offset}"))
            self._write(os.path.join(bank, f"line{offset}", "name"), line)
        self.lines = lines
        self.bank = bank
        self._write(os.path.join(self.folder, "live"), 1)
        self.chip = self._read(os.path.join(self.bank, "chip_name"))
        device = self._read(os.path.join(self.folder, "dev_name"))
        self.pins = os.path.join("/sys/devices/platform", device, self.chip)

    def set_level(self, line, high):
        self._write(os.path.join(self._pin(line), "pull"), "pull-up" if high else "pull-down")

    def value(self, line):
        return int(self._read(os.path.join(self._pin(line), "value")))

    def remove(self):
        """Not while a line is in use, which corrupts the memory of Linux 6.1."""
        self._write(os.path.join(self.folder, "live"), 0)
        for offset in range(len(self.lines)):
            os.rmdir(os.path.join(self.bank, f"line{offset}"))
        os.rmdir(self.bank)
        os.rmdir(self.folder)

    def _pin(self, line):
        return os.path.join(self.pins, f"sim_gpio{self.lines.index(line)}")

    @staticmethod
    def _write(path, value):
        with open(path, "w", encoding="ascii") as file:
            file.write(f"{value}\n")

    @staticmethod
    def _read(path):
        with open(path, encoding="ascii") as file:
            return file.read().strip()


# A daemon for a machine that computes slowly: it tracks, but coarsely.
SMALL_DAEMON = """
[lcm]
url = ""
[pipeline]
matcher_budget_ms = 20.0
scan_budget_ms = 40.0
sensor_priority = 10
matcher_priority = 0
watchdog_ms = 5000.0
[scan]
beams_max = 256
[matcher]
refine_steps = 1
[matcher.search]
start_points = 10
coarse_evaluations = 20
fine_evaluations = 20
simplex_steps = 3
[matcher.search.de]
population = 10
[matcher.reference.fine]
extent_m = 5.0
[matcher.reference.coarse]
extent_m = 5.0
[odometry.local_map.fine]
extent_m = 5.0
[odometry.local_map.coarse]
extent_m = 5.0
"""


class DaemonTest(HilTest):
    """A daemon, and an emulated laser for it: few beams at 10 Hz."""

    LASER = ("lrf", "--model", "urg-04lx", "--start-at-once", "--at-once")

    def start_laser(self, *line):
        with open(self.path("room.world"), "w", encoding="ascii") as world:
            world.write("room 0 0  6 4\nspeed 0.1\ngo 2 2  2.5 2\n")
        laser = self.start(*emulator(*self.LASER, "--from", self.path("room.world"), *line))
        self.addCleanup(time.sleep, 0.2)  # the kernel pulls a device out after its emulator's end
        return laser

    def start_daemon(self, lrf, more="", **environment):
        with open(self.path("robot.toml"), "w", encoding="ascii") as config:
            config.write(f'[lrf]\n{lrf}\ncluster = 8\n[control]\nsocket = "{self.path("control")}"\n{SMALL_DAEMON}{more}')
        self.log = open(self.path("daemon.log"), "w+", encoding="utf-8")
        self.addCleanup(self.log.close)
        return self.start(*program("odolessd", "--config", self.path("robot.toml"), "--stages", "sensor,matcher",
                                   "--enforce-realtime"), stderr=self.log, env={**os.environ, **environment})

    def said(self):
        """What the daemon has written so far."""
        with open(self.path("daemon.log"), encoding="utf-8") as log:
            return log.read()

    def status(self):
        """The daemon's answer to `status`; empty while it isn't there."""
        try:
            with socket.socket(socket.AF_UNIX) as control:
                control.settimeout(2)
                control.connect(self.path("control"))
                control.sendall(b"status\n")
                text = b""
                while chunk := control.recv(4096):
                    text += chunk
                return text.decode()
        except OSError:
            return ""

    def scans(self):
        found = re.search(r"scans (\d+) accepted", self.status())
        return int(found[1]) if found else 0

    def wait_for_scans(self, more, seconds):
        before = self.scans()
        try:
            return self.wait_until(lambda: self.scans() >= before + more, seconds, f"{more} scans more")
        except AssertionError:
            raise AssertionError(f"no scans:\n{self.status()}\n{self.said()}") from None

    @staticmethod
    def ranges(path):
        """Of each scan that a daemon has recorded."""
        return [data[16:] for channel, data in messages(path) if channel == "ODOLESS_SCAN"]

    def common_scans(self, first, second):
        """Those of both, to the bit: one may have begun or ended sooner."""
        common = [ranges for ranges in second if ranges in first]
        self.assertGreater(len(common), 0.9 * min(len(first), len(second)))
        places = [first.index(ranges) for ranges in common]
        self.assertEqual(places, sorted(places), "in order")
        return common
