"""What tests in the guest share: programs of the product, simulated GPIO chips, waiting."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAMS, SOURCES = sys.argv[1:3]


def program(name, *arguments):
    return [os.path.join(PROGRAMS, name), *map(str, arguments)]


def run(*command, timeout=60):
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)


class HilTest(unittest.TestCase):
    """A folder for each test; programs that it starts end with it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *command, **options):
        options.setdefault("stdout", subprocess.DEVNULL)
        process = subprocess.Popen(command, text=True, **options)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def wait_until(self, holds, seconds, what="it"):
        """Returns after how many seconds it held."""
        begin = time.monotonic()
        while not holds():
            self.assertLess(time.monotonic() - begin, seconds, f"{what} did not happen in {seconds} s")
            time.sleep(0.01)
        return time.monotonic() - begin


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
        self._write(os.path.join(self.folder, "live"), 1)
        self.lines = lines
        self.bank = bank
        self.chip = self._read(os.path.join(bank, "chip_name"))
        device = self._read(os.path.join(self.folder, "dev_name"))
        self.pins = os.path.join("/sys/devices/platform", device, self.chip)

    def set_level(self, line, high):
        self._write(os.path.join(self._pin(line), "pull"), "pull-up" if high else "pull-down")

    def value(self, line):
        return int(self._read(os.path.join(self._pin(line), "value")))

    def unplug(self):
        self._write(os.path.join(self.folder, "live"), 0)

    def plug(self):
        self._write(os.path.join(self.folder, "live"), 1)

    def remove(self):
        self.unplug()
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
