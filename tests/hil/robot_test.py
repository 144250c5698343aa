"""`odoless emulate robot`: laser, CAN servo and GPIO lines of one robot on one clock; and its recorded bytes again."""

import glob
import os
import signal
import subprocess
import time
import unittest

from support import DaemonTest, program, run
from lcm_log import messages  # found by support

WORLD = "room 0 0  6 4\nspeed 0.1\ngo 2 2  2.5 2\n"
WIRED = """
[tilt]
driver = "cia402"
device = "vcan0"
sample_period_ms = 20.0
"""
GPIO = """
[gpio]
stop_line = "bot-stop"
sync_line = "bot-sync"
power_line = "bot-power"
power_cycle_after_ms = 1500.0
power_off_ms = 500.0
"""


@unittest.skipUnless(os.path.exists("/sys/class/net/vcan0"), "no interface vcan0")
class RobotTest(DaemonTest):
    def setUp(self):
        super().setUp()
        run("ip", "link", "set", "vcan0", "up")

    def start_robot(self, *more, **options):
        robot = self.start(*program("odoless", "emulate", "robot", *more, "--pty", self.path("laser"),
                                    "--servo-can", "vcan0"), **options)
        self.wait_until(lambda: os.path.lexists(self.path("laser")), 10, "the robot")
        return robot

    def start_driving(self, *more):
        with open(self.path("room.world"), "w", encoding="ascii") as world:
            world.write(WORLD)
        return self.start_robot("--from", self.path("room.world"), "--model", "urg-04lx", *more)

    def start_recording(self, name, more=""):
        daemon = self.start_daemon(f'device = "{self.path("laser")}"',
                                   f'{WIRED}{more}[recorder]\npath = "{self.path(name)}"\n')
        self.wait_for_scans(5, 30)
        self.wait_until(self.obeys, 20, "obedience")
        return daemon

    def obeys(self):
        return "servo does not obey" not in (self.status() or "servo does not obey")

    def test_a_whole_robot_moves_stops_pulses_and_loses_its_power(self):
        robot = self.start_driving("--gpio", "bot", "--gpio-fault", "stop@14:3", "--fault", "silence@20:3")
        daemon = self.start_recording("run", GPIO)
        self.wait_until(lambda: "sync pulse is missing" not in (self.status() or "sync pulse is missing"), 10, "pulses")
        self.wait_until(lambda: "emergency stop" in self.status(), 20, "the stop")
        self.wait_until(lambda: "emergency stop" not in self.status(), 6, "the release")
        scans = self.scans()
        self.wait_until(lambda: "no scans" in self.status(), 15, "the silence")
        self.wait_until(lambda: self.scans() > scans + 20, 15, "scans after the power cycle")
        with open(self.path("daemon.log"), encoding="utf-8") as log:
            self.assertNotIn("GPIO line", log.read())
        self.finish(daemon, robot)
        self.assertFalse(os.path.exists("/sys/kernel/config/gpio-sim/bot"), "a chip that nobody uses is removed")

    def test_recorded_bytes_of_laser_and_bus_come_again(self):
        robot = self.start_driving()
        daemon = self.start_recording("first", 'at_start = "sweep"\n')
        time.sleep(3)
        self.finish(daemon, robot)
        (log,) = glob.glob(self.path("first.*.lcm"))
        dump = b"".join(data[20:] for channel, data in messages(log) if channel.startswith("ODOLESS_TILT_RAW"))
        with open(self.path("bus.log"), "wb") as file:
            file.write(dump)
        self.assertEqual(run("canplayer", "-I", self.path("bus.log"), "-t", "vcan0=vcan0").returncode, 0,
                         "the recorded frames are a log of candump")
        robot = self.start_robot("--from-raw", log, stdout=subprocess.PIPE)
        daemon = self.start_recording("second", 'at_start = "sweep"\n')
        time.sleep(3)
        self.finish(daemon, robot)
        (again,) = glob.glob(self.path("second.*.lcm"))
        first, second = (self.ranges(path) for path in (log, again))
        count = min(len(first), len(second))
        self.assertGreater(count, 20)
        self.assertEqual(first[:count], second[:count], "the ranges are the recorded ones to the bit")
        angles = [sum(channel == "ODOLESS_TILT" for channel, _ in messages(path)) for path in (log, again)]
        print(f"  raw replay: {count} scans equal to the bit; {angles[0]} angles recorded, {angles[1]} again; "
              + " ".join(robot.stdout.read().split("\n")[2:]))
        self.assertGreater(angles[1], 0.7 * angles[0])

    def finish(self, daemon, robot):
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=20), 0)
        robot.send_signal(signal.SIGTERM)
        robot.wait(timeout=5)

    @staticmethod
    def ranges(path):
        return [data[16:] for channel, data in messages(path) if channel == "ODOLESS_SCAN"]
