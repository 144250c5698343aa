"""The emergency stop of a moving servo, end to end: an edge on a GPIO line, through the daemon, to the CAN bus."""

import os
import socket
import struct
import time
import unittest

from support import PROGRAMS, DaemonTest, SimulatedGpio, emulator, run

SO_TIMESTAMPNS = 35  # of asm-generic/socket.h; Python has no name for it
SYNC, COMMAND, STATUS = 0x080, 0x201, 0x181  # and PDOs of node 1
PERIOD_S = 0.01  # of SYNC
QUICK_STOP_BITS, QUICK_STOP = 0x86, 0x02  # CiA 402-2, control word: quick stop is bit 2 low and bit 1 high
SWEEPING = """
[tilt]
driver = "cia402"
device = "vcan0"
at_start = "sweep"
sample_period_ms = 10.0
[gpio]
stop_line = "odo-stop"
"""


class Bus:
    """Frames of the servo, with the kernel's stamps: (realtime in s, id, data)."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        filters = b"".join(struct.pack("=II", number, 0x7FF) for number in (SYNC, COMMAND, STATUS))
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
        self.socket.bind(("vcan0",))
        self.socket.setblocking(False)

    def read(self):
        frames = []
        while True:
            try:
                data, control, _, _ = self.socket.recvmsg(16, 64)
            except BlockingIOError:
                return frames
            seconds, nanoseconds = struct.unpack("=qq", control[0][2][:16])
            number, size = struct.unpack("=IB", data[:5])
            frames.append((seconds + nanoseconds * 1e-9, number, data[8:8 + size]))


def positions(frames):
    """(stamp, position) of each status."""
    return [(stamp, struct.unpack("<i", data[2:6])[0]) for stamp, number, data in frames if number == STATUS]


def is_quick_stop(number, data):
    return number == COMMAND and struct.unpack("<H", data[:2])[0] & QUICK_STOP_BITS == QUICK_STOP


@unittest.skipUnless(os.path.exists("/sys/class/net/vcan0"), "no interface vcan0")
class StopTest(DaemonTest):
    LIMIT_S = 0.2

    def setUp(self):
        super().setUp()
        run("ip", "link", "set", "vcan0", "up")
        self.gpio = SimulatedGpio("stopping", ["odo-stop"])
        self.addCleanup(self.gpio.remove)
        self.bus = Bus()
        self.addCleanup(self.bus.socket.close)
        self.lost = self.path("lost")
        servo = emulator("servo", "--cia402", "--can", "vcan0")
        self.start(*servo)
        self.start_daemon('device = "/nonexistent/laser"', SWEEPING,
                          LD_PRELOAD=os.path.join(PROGRAMS, "liblost_gpio.so"), ODOLESS_LOST_GPIO=self.lost)
        self.wait_until(self.is_released, 20, "the release")

    def is_released(self):
        self.gpio.set_level("odo-stop", True)  # again: opened anew, it is pulled down
        return "emergency stop" not in (self.status() or "emergency stop")

    def wait_until_it_moves(self):
        """In the middle of a sweep, so that it would go on for long."""
        last = []

        def is_in_the_middle():
            last.extend(positions(self.bus.read()))
            del last[:-5]
            steps = [after[1] - before[1] for before, after in zip(last, last[1:])]
            return len(steps) == 4 and min(map(abs, steps)) > 20 and abs(last[-1][1]) < 2000

        self.wait_until(is_in_the_middle, 20, "a sweep")

    def stops(self, cause, undo):
        """Seconds from `cause` to the command and to the last motion that the bus saw."""
        self.wait_until_it_moves()
        begin = time.time()
        cause()
        time.sleep(0.6)
        after = [frame for frame in self.bus.read() if frame[0] >= begin]
        undo()
        self.wait_until(self.is_released, 5, "the release")
        commanded = next((stamp for stamp, number, data in after if is_quick_stop(number, data)), None)
        self.assertIsNotNone(commanded, "no quick stop on the bus")
        self.assertLess(sum(number == SYNC for _, number, _ in after), 1.5 * 0.6 / PERIOD_S, "the bus is flooded")
        seen = positions(after)
        self.assertGreater(len(seen), 20)
        stood = next(stamp for stamp, position in seen if position == seen[-1][1])
        self.assertTrue(all(position == seen[-1][1] for stamp, position in seen if stamp >= stood), "it moved again")
        self.assertGreater(seen[-1][0] - begin, 0.5, "the servo fell silent")
        return commanded - begin, stood - begin

    def check(self, name, cause, undo):
        for _ in range(2):
            commanded_s, stood_s = self.stops(cause, undo)
            print(f"  {name}: quick stop on the bus after {commanded_s * 1e3:.1f} ms, zero velocity after {stood_s * 1e3:.1f} ms")
            self.assertLess(stood_s, self.LIMIT_S)

    def test_an_edge_and_a_lost_line_stop_the_moving_servo_within_200_ms(self):
        def lose():
            with open(self.lost, "w", encoding="ascii"):
                pass

        self.check("edge", lambda: self.gpio.set_level("odo-stop", False), lambda: None)
        self.check("lost line", lose, lambda: os.remove(self.lost))
        self.wait_until_it_moves()
