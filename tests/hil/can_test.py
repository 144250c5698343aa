"""A CiA 402 servo on vcan0: brought up and swept by the daemon, through faults of the bus; what can-utils sees of it."""

import os
import re
import signal
import time
import unittest

from support import DaemonTest, program, run
from host_watch import keep_promise  # found by support

LASER = 'device = "/nonexistent/laser"'
NOT_LEVEL, DISOBEYS = "not level", "servo does not obey"


@unittest.skipUnless(os.path.exists("/sys/class/net/vcan0"), "no interface vcan0")
class CanTest(DaemonTest):
    def setUp(self):
        super().setUp()
        run("ip", "link", "set", "vcan0", "up")

    def start_servo(self, *more):
        return self.start(*program("odoless", "emulate", "servo", "--cia402", "--can", "vcan0", *more))

    def start_tilting(self, more=""):
        self.start_daemon(LASER, f'[tilt]\ndriver = "cia402"\ndevice = "vcan0"\nsample_period_ms = 20.0\n{more}')

    def report(self):
        self.log.seek(0)
        return self.log.read()

    def obeys(self):
        state = self.status().partition("\n")[0]
        return bool(state) and DISOBEYS not in state

    def wait_until_it_obeys(self, seconds):
        return self.wait_until(self.obeys, seconds, "obedience")

    def test_the_daemon_brings_a_servo_up_and_sweeps_as_the_standard_has_it(self):
        dump = self.start("candump", "-L", "vcan0", stdout=open(self.path("bus.log"), "w", encoding="ascii"))
        self.wait_until(lambda: os.path.exists(self.path("bus.log")), 5)
        time.sleep(0.5)
        self.start_servo()
        self.start_tilting('at_start = "sweep"\n')
        self.wait_until_it_obeys(20)
        time.sleep(8)
        dump.send_signal(signal.SIGTERM)
        dump.wait()
        with open(self.path("bus.log"), encoding="ascii") as file:
            frames = [line.split()[2] for line in file]
        wanted = [
            r"000#8001",  # pre-operational
            r"601#4000100000000000",  # device type?
            r"581#4300100092010200",  # a servo drive
            r"601#2B17100064000000",  # a heartbeat each 100 ms
            r"601#2300180181010?0C0|601#23001801810100C0",  # TPDO 1 off, to be mapped
            r"601#23001A0110004160",  # to it: 6041h
            r"601#2F60600001000000",  # profile position mode
            r"000#0101",  # start
            r"080#",  # SYNC
            r"181#..............",  # status word, position, mode
            r"201#0600........",  # shutdown
            r"201#0700........",  # switch on
            r"201#0F00........",  # enable operation
            r"201#3F00........",  # a new set point
        ]
        at = 0
        for pattern in wanted:
            while at < len(frames) and not re.fullmatch(pattern, frames[at]):
                at += 1
            self.assertLess(at, len(frames), f"no {pattern} in its order")
        self.assertIn("701#05", frames)
        self.assertIn("77F#05", frames)
        position = [int.from_bytes(bytes.fromhex(frame[8:16]), "little", signed=True)
                    for frame in frames if frame.startswith("181#")]
        self.assertGreater(max(position), 5000, self.report())  # 27 deg of 65536 per turn
        self.assertLess(min(position), -5000, self.report())

    def test_a_link_that_goes_down_and_up_is_used_again_within_a_second(self):
        self.start_servo()
        self.start_tilting()
        self.wait_until_it_obeys(20)

        def time_to_obey():
            run("ip", "link", "set", "vcan0", "down")
            self.wait_until(lambda: not self.obeys(), 2, "the flag")
            time.sleep(1)
            run("ip", "link", "set", "vcan0", "up")
            return self.wait_until_it_obeys(10)

        keep_promise(self, 1.0, time_to_obey)

    def test_error_frames_and_a_flood_of_id_0_are_survived(self):
        self.start_servo()
        self.start_tilting()
        self.wait_until_it_obeys(20)

        def time_after_bus_off():
            run("cansend", "vcan0", "20000040#0000000000000000")
            self.wait_until(lambda: not self.obeys(), 2, "the flag")
            return self.wait_until_it_obeys(10)

        def time_after_a_flood():
            flood = self.start("cangen", "vcan0", "-I", "000", "-L", "8", "-D", "8001000000000000", "-g", "1")
            time.sleep(2)
            flood.kill()
            flood.wait()
            return self.wait_until_it_obeys(10)

        keep_promise(self, 1.0, time_after_bus_off)
        keep_promise(self, 1.0, time_after_a_flood)

    def test_a_servo_that_dies_is_flagged_and_had_again(self):
        servo = self.start_servo()
        self.start_tilting()
        self.wait_until_it_obeys(20)
        servo.kill()
        servo.wait()
        self.wait_until(lambda: not self.obeys(), 1.0, "the flag")
        self.start_servo()
        self.wait_until_it_obeys(5)

