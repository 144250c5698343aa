"""A CiA 402 servo on vcan0: brought up and swept by the daemon, through faults of the bus; what can-utils sees of it."""

import os
import re
import signal
import struct
import time
import unittest

try:
    import can
except ImportError:
    can = None
from support import DaemonTest, emulator, run

if can:
    from foreign_drive import ForeignDrive

LASER = 'device = "/nonexistent/laser"'
NOT_LEVEL, DISOBEYS = "not level", "servo does not obey"


class CanTestBase(DaemonTest):
    def setUp(self):
        super().setUp()
        run("ip", "link", "set", "vcan0", "up")

    def start_servo(self, *more):
        return self.start(*emulator("servo", "--cia402", "--can", "vcan0", *more))

    def start_tilting(self, more=""):
        return self.start_daemon(LASER, f'[tilt]\ndriver = "cia402"\ndevice = "vcan0"\nsample_period_ms = 20.0\n{more}')

    def report(self):
        self.log.seek(0)
        return self.log.read()

    def obeys(self):
        state = self.status().partition("\n")[0]
        return bool(state) and DISOBEYS not in state

    def wait_until_it_obeys(self, seconds):
        return self.wait_until(self.obeys, seconds, "obedience")


@unittest.skipUnless(os.path.exists("/sys/class/net/vcan0"), "no interface vcan0")
class CanTest(CanTestBase):
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

        self.assertLess(time_to_obey(), 1.0)

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

        self.assertLess(time_after_bus_off(), 1.0)
        self.assertLess(time_after_a_flood(), 1.0)

    def test_a_servo_that_dies_is_flagged_and_had_again(self):
        servo = self.start_servo()
        self.start_tilting()
        self.wait_until_it_obeys(20)
        servo.kill()
        servo.wait()
        self.wait_until(lambda: not self.obeys(), 1.0, "the flag")
        self.start_servo()
        self.wait_until_it_obeys(5)


@unittest.skipUnless(can and os.path.exists("/sys/class/net/vcan0"), "no python3-can, or no interface vcan0")
class ForeignDriveTest(CanTestBase):
    BY_VALUE = {(0x605A, 0): 0x06090030, (0x6007, 0): 0x06090030, (0x1016, 1): 0x06040043}

    def expect_sweeps(self, refused):
        """@return  The drive and the daemon, in the middle of a sweep."""
        drive = ForeignDrive("vcan0", refused)
        self.addCleanup(drive.end)
        daemon = self.start_tilting('at_start = "sweep"\n')
        try:
            self.wait_until(lambda: drive.position() > 3000, 30, "a sweep up")
            self.wait_until(lambda: drive.position() < -3000, 30, "a sweep down")
        except AssertionError as error:
            raise AssertionError(f"{error}:\n{self.report()}") from None
        self.assertEqual(drive.refusals, set(refused))
        return drive, daemon

    def test_a_foreign_drive_sweeps(self):
        self.expect_sweeps({})

    def test_a_foreign_drive_that_refuses_optional_values_sweeps(self):
        self.expect_sweeps(self.BY_VALUE)

    def test_a_foreign_drive_holds_still_at_the_daemons_end(self):
        drive, daemon = self.expect_sweeps({})
        self.wait_until(lambda: -1000 < drive.position() < 1000, 30, "the middle of a sweep")
        daemon.send_signal(signal.SIGTERM)
        self.end_of(daemon)
        at_the_end = drive.position()
        time.sleep(1)
        self.assertEqual(drive.position(), at_the_end)


@unittest.skipUnless(can and os.path.exists("/sys/class/net/vcan0"), "no python3-can, or no interface vcan0")
class ForeignMasterTest(CanTestBase):
    """A master that knows CiA 301 and 402 alone, with python3-can."""

    NODE = 1

    def setUp(self):
        super().setUp()
        self.bus = can.Bus(channel="vcan0", interface="socketcan")
        self.addCleanup(self.bus.shutdown)

    def hear(self, cob, data=None, seconds=5):
        """The next frame with that id, and those bytes where they are given."""
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            frame = self.bus.recv(left_s)
            if frame and frame.arbitration_id == cob and data in (None, bytes(frame.data)):
                return bytes(frame.data)
        return self.fail(f"no frame {cob:03X} {data}")

    def say(self, cob, data):
        self.bus.send(can.Message(arbitration_id=cob, data=data, is_extended_id=False))

    def sdo(self, request):
        self.say(0x600 + self.NODE, request.ljust(8, b"\0"))
        return self.hear(0x580 + self.NODE)

    def read(self, index, sub=0):
        answer = self.sdo(struct.pack("<BHB", 0x40, index, sub))
        self.assertEqual(answer[1:4], struct.pack("<HB", index, sub))
        self.assertIn(answer[0], (0x43, 0x47, 0x4B, 0x4F), answer.hex())
        return int.from_bytes(answer[4:4 + 4 - (answer[0] >> 2 & 3)], "little", signed=True)

    def write(self, index, value, size, sub=0):
        command = {1: 0x2F, 2: 0x2B, 4: 0x23}[size]
        answer = self.sdo(struct.pack("<BHB", command, index, sub) + value.to_bytes(size, "little", signed=True))
        self.assertEqual(answer[0], 0x60, answer.hex())

    def test_it_moves_a_drive(self):
        self.start_servo()
        self.wait_until(lambda: self.bus.recv(0.1), 20, "the boot-up message")
        self.say(0, [0x81, self.NODE])
        self.hear(0x700 + self.NODE, b"\0")
        self.assertEqual(self.read(0x1000) & 0xFFFF, 402)
        refused = self.sdo(struct.pack("<BHB", 0x40, 0x5FFF, 0))
        self.assertEqual(refused[0:1] + refused[4:], b"\x80" + struct.pack("<I", 0x06020000), "no such object")
        self.write(0x1017, 50, 2)
        self.hear(0x700 + self.NODE, b"\x7f")
        self.say(0, [0x01, self.NODE])
        self.hear(0x700 + self.NODE, b"\x05")
        self.write(0x6060, 1, 1)
        for word, state in ((0x06, 0x21), (0x07, 0x23), (0x0F, 0x27)):
            self.write(0x6040, word, 2)
            self.wait_until(lambda expected=state: self.read(0x6041) & 0x6F == expected, 5, f"state {state:02X}h")
        goal = self.read(0x6064) + 500
        for index, value in ((0x6081, 2000), (0x6083, 20000), (0x6084, 20000), (0x607A, goal)):
            self.write(index, value, 4)
        self.write(0x6040, 0x3F, 2)
        self.wait_until(lambda: self.read(0x6041) & 0x1000, 5, "the set point's acknowledgement")
        self.wait_until(lambda: self.read(0x6041) & 0x400, 10, "target reached")
        self.assertLessEqual(abs(self.read(0x6064) - goal), 2)

    def aborts(self, command, index, sub, value=0):
        answer = self.sdo(struct.pack("<BHBI", command, index, sub, value))
        return struct.unpack("<I", answer[4:])[0] if answer[0] == 0x80 else None

    def heard(self, cob, seconds):
        """How many frames with that id come in that time."""
        end_s = time.monotonic() + seconds
        count = 0
        while (left_s := end_s - time.monotonic()) > 0:
            frame = self.bus.recv(left_s)
            count += bool(frame and frame.arbitration_id == cob)
        return count

    def test_it_finds_what_cia_301_has(self):
        self.start_servo()
        self.wait_until(lambda: self.bus.recv(0.1), 20, "the boot-up message")
        self.assertEqual(self.read(0x1014), 0x80 + self.NODE)
        for index, sub, code in ((0x1018, 9, 0x06090011), (0x6064, 1, 0x06090011), (0x2000, 0, 0x06020000)):
            self.assertEqual(self.aborts(0x40, index, sub), code, f"{index:X}:{sub}")
        self.assertEqual(self.aborts(0x23, 0x1800, 1, 0x182), 0x06090030, "a valid PDO keeps its id")
        for request in (b"\x80\x64\x60\0\0\0\x04\x05", b"\x40\x64\x60\0"):
            self.say(0x600 + self.NODE, request)
            self.assertEqual(self.heard(0x580 + self.NODE, 0.5), 0, f"an answer to {request.hex()}")
        self.assertEqual(self.sdo(b"\x21\x81\x60\0\x04")[0], 0x60)
        self.assertEqual(self.sdo(b"\x07\x78\x56\x34\x12")[0], 0x20)
        self.assertEqual(self.read(0x6081), 0x12345678, "a download by segments")

    def test_it_sends_a_pdo_at_every_third_sync(self):
        self.start_servo()
        self.wait_until(lambda: self.bus.recv(0.1), 20, "the boot-up message")
        for value, size, index, sub in ((-2**31 + 0x181, 4, 0x1800, 1), (0, 1, 0x1A00, 0), (0x60410010, 4, 0x1A00, 1),
                                        (1, 1, 0x1A00, 0), (3, 1, 0x1800, 2), (0x40000181, 4, 0x1800, 1)):
            self.write(index, value, size, sub)
        self.say(0, [0x01, self.NODE])
        self.say(0x201, b"\x06")  # too short: told, not taken
        self.hear(0x80 + self.NODE)
        for _ in range(9):
            self.say(0x80, b"")
            time.sleep(0.02)
        self.assertEqual(self.heard(0x181, 0.5), 3)

    def test_it_finds_what_cia_402_has(self):
        self.start_servo("--fault", "error=8976@0:1")
        self.hear(0x80 + self.NODE, seconds=20)
        self.assertEqual(self.read(0x1001), 0x03, "something, and the current")
        self.assertEqual(self.read(0x6502), 0xA1)
        self.assertEqual(self.aborts(0x2F, 0x6060, 0, 100), 0x06090030, "a mode that no drive has")
        time.sleep(1)
        for word in (0x00, 0x80):
            self.write(0x6040, word, 2)
        self.assertEqual(self.hear(0x80 + self.NODE)[:2], b"\0\0", "the error is gone")
        self.assertEqual(self.read(0x1001), 0)

    def test_it_leaves_the_operational_state_without_its_master(self):
        self.start_servo()
        self.wait_until(lambda: self.bus.recv(0.1), 20, "the boot-up message")
        self.write(0x1017, 50, 2)
        self.write(0x1016, 127 << 16 | 200, 4, 1)
        self.say(0, [0x01, self.NODE])
        self.hear(0x700 + self.NODE, b"\x05")
        self.say(0x77F, b"\x05")
        self.hear(0x700 + self.NODE, b"\x7f")
