"""`odoless emulate robot`: laser, CAN servo and GPIO lines of one robot on one clock; and its recorded bytes again."""

import glob
import os
import signal
import struct
import subprocess
import time
import unittest

from support import DaemonTest, emulator, run
from lcm_log import messages  # found by support

WORLD = "room 0 0  6 4\nspeed 0.1\ngo 2 2  2.5 2\n"
WIRED = """
[tilt]
driver = "cia402"
device = "vcan0"
sample_period_ms = 20.0
reply_timeout_ms = 500.0
stall_timeout_ms = 1000.0
heartbeat_period_ms = 500.0
"""
# Whichever comes first when the daemon is up.
STOPS = [word for begin_s in range(5, 100, 10) for word in ("--gpio-fault", f"stop@{begin_s}:3")]
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
        robot = self.start(*emulator("robot", *more, "--pty", self.path("laser"), "--servo-can", "vcan0"), **options)
        self.wait_until(lambda: os.path.lexists(self.path("laser")), 10, "the robot")
        return robot

    def start_driving(self, *more):
        with open(self.path("room.world"), "w", encoding="ascii") as world:
            world.write(WORLD)
        return self.start_robot("--from", self.path("room.world"), "--model", "urg-04lx", *more)

    def start_recording(self, name, more=""):
        return self.start_daemon(f'device = "{self.path("laser")}"',
                                 f'{WIRED}{more}[recorder]\npath = "{self.path(name)}"\n')

    def wait_until_all_works(self):
        self.wait_for_scans(5, 60)
        self.wait_until(self.obeys, 60, "obedience")

    def obeys(self):
        return "servo does not obey" not in (self.status() or "servo does not obey")

    def test_a_whole_robot_moves_stops_pulses_and_loses_its_power(self):
        robot = self.start_driving("--gpio", "bot", *STOPS, "--fault", "silence@13:3", "--fault", "silence@33:3")
        daemon = self.start_recording("run", GPIO)
        self.wait_until_all_works()
        self.wait_until(lambda: "sync pulse is missing" not in (self.status() or "sync pulse is missing"), 10, "pulses")
        self.wait_for_a_stop()
        self.wait_until(lambda: "no scans" in self.status(), 60, "the silence")
        scans = self.scans()
        self.wait_until(lambda: self.scans() > scans + 20, 30, "scans after the power cycle")
        self.finish(daemon, robot)
        (log,) = glob.glob(self.path("run.*.lcm"))
        self.assertNotIn(b"lost", b"".join(data for channel, data in messages(log) if "GPIO_RAW" in channel))
        self.assertFalse(os.path.exists("/sys/kernel/config/gpio-sim/bot"), "a chip that nobody uses is removed")

    def is_stopped(self):
        return "emergency stop" in self.status()

    def wait_for_a_stop(self):
        self.wait_until(lambda: not self.is_stopped(), 15, "the end of a stop that has begun before")
        self.wait_until(self.is_stopped, 60, "the stop")
        self.wait_until(lambda: not self.is_stopped(), 15, "the release")
        time.sleep(1)

    def test_recorded_bytes_of_laser_and_bus_and_the_wires_come_again(self):
        robot = self.start_driving("--gpio", "bot", *STOPS)
        daemon = self.start_recording("first", 'at_start = "sweep"\n' + GPIO)
        self.wait_until_all_works()
        self.wait_for_a_stop()
        self.finish(daemon, robot)
        (log,) = glob.glob(self.path("first.*.lcm"))
        dump = b"".join(data[20:] for channel, data in messages(log) if channel.startswith("ODOLESS_TILT_RAW"))
        with open(self.path("bus.log"), "wb") as file:
            file.write(dump)
        self.assertEqual(run("canplayer", "-I", self.path("bus.log"), "-t", "vcan0=vcan0").returncode, 0,
                         "the recorded frames are a log of candump")
        robot = self.start_robot("--from-raw", log, "--gpio", "bot", "--stop-at-end", stdout=subprocess.PIPE)
        daemon = self.start_recording("second", 'at_start = "sweep"\n' + GPIO)
        self.end_of(robot, 120)
        self.finish(daemon, robot)
        (again,) = glob.glob(self.path("second.*.lcm"))
        first, second = (self.ranges(path) for path in (log, again))
        common = self.common_scans(first, second)
        self.assertGreater(len(common), 20)
        angles, angles_again = self.angles(log), self.angles(again)
        print(f"  raw replay: {len(common)} scans of {len(first)} equal to the bit; {len(angles)} angles recorded, {len(angles_again)} again; "
              + " ".join(robot.stdout.read().split("\n")[2:]))
        self.assertGreater(len(angles_again), 100)
        recorded = set(angles)  # but for those that the daemon was told of and refused, as when two came for one SYNC
        self.assertLess(sum(angle not in recorded for angle in angles_again), 0.05 * len(angles_again))
        self.check_wires(log, again, common)

    def check_wires(self, log, log_again, common):
        """Stop and pulses lie where they were among these scans."""
        (scans_s, wires), (scans_again_s, wires_again) = self.stamps(log), self.stamps(log_again)
        begin_s = scans_s[common[0]]
        again_s = scans_again_s[common[0]]
        presses, presses_again = ([(stamp_s - start_s, text) for stamp_s, text in lines
                                   if text.startswith(b"stop") and stamp_s > start_s]
                                  for lines, start_s in ((wires, begin_s), (wires_again, again_s)))
        count = min(len(presses), len(presses_again))
        self.assertGreaterEqual(count, 2)
        self.assertEqual([text for _, text in presses[:count]], [text for _, text in presses_again[:count]])
        late_s = [b - a for (a, _), (b, _) in zip(presses, presses_again)]
        pulses, pulses_again = ([stamp_s - start_s for stamp_s, text in lines if text == b"sync high\n"]
                                for lines, start_s in ((wires, begin_s), (wires_again, again_s)))
        off_s = sorted(min(abs(again - pulse) for pulse in pulses) for again in pulses_again)
        print(f"  wires: stop pressed and released {late_s[0] * 1e3:.1f} and {late_s[1] * 1e3:.1f} ms off its place among "
              f"the scans; {len(pulses)} pulses recorded, {len(pulses_again)} again, at most {max(off_s) * 1e3:.1f} ms off")
        self.assertLess(max(map(abs, late_s)), 0.01)
        self.assertGreater(len(pulses_again), 0.9 * len(pulses))
        self.assertLess(max(off_s), 0.01)

    def finish(self, daemon, robot):
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(self.end_of(daemon), 0, self.said())
        robot.send_signal(signal.SIGTERM)
        self.end_of(robot, 5)

    @staticmethod
    def stamps(path):
        """Of the scans by their ranges, in s; of the changes of inputs, each with its text."""
        found = [(channel, struct.unpack(">q", data[8:16])[0] * 1e-6, data) for channel, data in messages(path)]
        return ({data[16:]: stamp_s for channel, stamp_s, data in found if channel == "ODOLESS_SCAN"},
                [(stamp_s, data[20:]) for channel, stamp_s, data in found if channel == "ODOLESS_GPIO_RAW_RX"])

    @staticmethod
    def angles(path):
        """The bytes of each, behind stamp, number of joints and the joint's name."""
        return [data[27:31] for channel, data in messages(path) if channel == "ODOLESS_TILT"]
