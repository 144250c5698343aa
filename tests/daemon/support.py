"""What tests of the daemon share: the daemon, emulated devices and `odoless ctl`, as on a robot."""

import bisect
import concurrent.futures
import json
import math
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAMS, SOURCES = sys.argv[1:3]
sys.path.append(os.path.join(SOURCES, "tests", "support"))
from host_watch import HostWatch, wait_for  # there
WORLD = os.path.join(SOURCES, "tools", "worlds", "rooms.world")


def alone(test):
    """For a test whose figures are the machine's, too: nothing runs beside it."""
    test.is_alone = True
    return test


def main(at_once=3):
    """Runs the tests that the command line names, or all of the program: each in a process of its own, since it mostly waits.

    at_once: a daemon, its laser and the test take up to 0.4 of a processor.
    """
    if len(sys.argv) > 3:
        unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
    beside, by_itself = [], []
    for case in vars(sys.modules["__main__"]).values():
        for name in unittest.defaultTestLoader.getTestCaseNames(case) if is_case(case) else ():
            (by_itself if hasattr(getattr(case, name), "is_alone") else beside).append(f"{case.__name__}.{name}")
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        went_well = list(pool.map(run_in_own_process, beside)) + list(map(run_in_own_process, by_itself))
    sys.exit(not (went_well and all(went_well)))


def is_case(thing):
    return isinstance(thing, type) and issubclass(thing, unittest.TestCase)


def run_in_own_process(name):
    done = subprocess.run([sys.executable, "-B", *sys.argv, name], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    print(done.stdout, flush=True)
    return done.returncode == 0


def program(name, *arguments):
    return [os.path.join(PROGRAMS, name), *map(str, arguments)]


def run(*command, timeout=120):
    return subprocess.run(program(*command), capture_output=True, text=True, timeout=timeout, check=False)


def poses(path):
    """x, y and yaw by the stamp in us."""
    with open(path, encoding="utf-8") as file:
        rows = [list(map(float, line.split())) for line in file if not line.startswith("#")]
    return {round(row[0] * 1e6): (row[1], row[2], 2.0 * math.atan2(row[6], row[7])) for row in rows}


def yaw_errors_deg(truth, estimate):
    """Of each pose against the truth at its stamp, between two true ones. Both begin with the same heading: where a robot turns
    on the spot, an alignment by its positions would turn them as it likes."""
    stamps_us = sorted(truth)
    errors_deg = []
    for stamp_us, (_, _, yaw_rad) in sorted(estimate.items()):
        after = bisect.bisect(stamps_us, stamp_us)
        if 0 < after < len(stamps_us):
            before_us, after_us = stamps_us[after - 1], stamps_us[after]
            turn_rad = math.remainder(truth[after_us][2] - truth[before_us][2], 2.0 * math.pi)
            true_rad = truth[before_us][2] + turn_rad * (stamp_us - before_us) / (after_us - before_us)
            errors_deg.append(math.degrees(math.remainder(yaw_rad - true_rad, 2.0 * math.pi)))
    return errors_deg


class DaemonCase(unittest.TestCase):
    laser_world = WORLD  # where the laser is

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.processes = []
        self.config = self.write_config("robot.toml")

    def path(self, name):
        return os.path.join(self.folder, name)

    def write_config(self, name, more="", device=None, lrf="", url='url = ""\n', socket="control"):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(
                f'[lrf]\ndevice = "{device or self.path("laser")}"\n{lrf}[lcm]\n{url}'
                f'[control]\nsocket = "{self.path(socket)}"\n{more}'
            )
        return self.path(name)

    def start(self, *command, stdout=subprocess.DEVNULL, environment=None):
        process = subprocess.Popen(program(*command), stdout=stdout, stderr=subprocess.PIPE, text=True,
                                   env=os.environ | (environment or {}))
        self.addCleanup(self.end, process)
        self.processes.append(process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def start_laser(self, *more):
        laser = self.start("odoless", "emulate", "lrf", "--from", self.laser_world, "--pty", self.path("laser"), *more)
        self.wait_until(lambda: os.path.lexists(self.path("laser")), 10)
        self.addCleanup(self.forget, "laser")  # before it is ended
        return laser

    def other_way(self, left_out, instead):
        """rooms.world with other statements instead of those that begin so."""
        with open(WORLD, encoding="utf-8") as file:
            rest = [line for line in file if not line.startswith(left_out)]
        with open(self.path("other_way.world"), "w", encoding="utf-8") as file:
            file.writelines([*rest, instead])
        return file.name

    def forget(self, name):
        """Removes a device's name, as udev does. One that is left leads to whoever is given the same terminal next, which may be the
        laser of another test on this machine: a daemon that waits for its own would open and lock that one."""
        if os.path.lexists(self.path(name)):
            os.remove(self.path(name))

    def unplug(self, process, name):
        self.forget(name)
        process.kill()

    def start_daemon(self, *more, environment=None):
        return self.start("odolessd", "--config", self.config, "--out", self.path("out"), *more, environment=environment)

    def faulty_disk(self, at=""):
        """The environment of a program whose disk does what `disk` says. at: part of the paths of a database."""
        library = self.path("disk_faults.so")
        compiler = shutil.which("cc") or shutil.which("gcc")
        if compiler is None:
            self.skipTest("there is no C compiler")
        subprocess.run([compiler, "-shared", "-fPIC", "-o", library, os.path.join(SOURCES, "tests/daemon/disk_faults.c"), "-ldl"],
                       check=True)
        return {"LD_PRELOAD": library, "DISK_FAULT": self.path("fault")} | ({"DISK_FAULT_AT": at} if at else {})

    def disk(self, fault):
        with open(self.path("fault.new"), "w", encoding="ascii") as file:
            file.write(fault)
        os.replace(self.path("fault.new"), self.path("fault"))

    def start_servo(self, *more):
        servo = self.start("odoless", "emulate", "servo", "--dynamixel", "--pty", self.path("servo"), *more)
        self.wait_until(lambda: os.path.lexists(self.path("servo")), 10)
        self.addCleanup(self.forget, "servo")
        return servo

    def use_servo(self, more=""):
        # Patience for a busy machine: the kernel lets a poll of a terminal wait for the worker that carries its bytes.
        tilt = f'[pipeline]\nwatchdog_ms = 5000.0\n[tilt]\ndriver = "dynamixel"\ndevice = "{self.path("servo")}"\nbaud = 0\n'
        tilt += "reply_timeout_ms = 200.0\nstall_timeout_ms = 500.0\nheartbeat_period_ms = 500.0\n"
        self.config = self.write_config("tilting.toml", tilt + more)

    def servo_obeys(self):
        state = self.state()
        return bool(state) and "servo does not obey" not in state

    def wait_until(self, holds, seconds, pause_s=0.01):
        """Returns after how many seconds it held."""
        waited_s = wait_for(holds, seconds, pause_s)
        if waited_s is None:
            self.fail(f"did not happen in {seconds} s; the daemon says: {self.state() or self.last_words()}")
        return waited_s

    def stop_in_time(self, daemon):
        """It drains, saves and ends within a second; what the machine withheld does not count."""
        with HostWatch() as host:
            asked = time.monotonic()
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(timeout=10), 0, daemon.stderr.read())
            took_s = time.monotonic() - asked
        print(f"  ended after {took_s:.3f} s, of which the machine withheld {host.withheld_s:.3f} s")
        self.assertLess(took_s - host.withheld_s, 1.0)

    def ctl(self, *command):
        return run("odoless", "ctl", "--socket", self.path("control"), *command)

    def answer(self, command):
        """As odoless ctl, but without the time that a program takes to start."""
        with socket.socket(socket.AF_UNIX) as client:
            client.connect(self.path("control"))
            client.sendall(command.encode() + b"\n")
            return client.makefile().read()

    def answer_s(self):
        """How long a question takes, which is not the daemon's time to notice."""
        begin = time.monotonic()
        for _ in range(3):
            self.answer("status")
        return time.monotonic() - begin

    def wait_until_ok(self):
        self.wait_until(lambda: self.state() == "OK", 10)

    def last_words(self):
        """Of the programs that have ended: how, and what they said."""
        return "".join(f"{process.args[0]} has ended with {process.returncode}: {process.stderr.read()}"
                       for process in self.processes if process.poll() is not None)

    def state(self):
        return self.ctl("status").stdout.split("\n")[0]

    def summary(self):
        with open(self.path("out/latest/summary.json"), encoding="utf-8") as file:
            return json.load(file)
