"""That the guest has what the other tests stand on: a CAN bus, and GPIO lines."""

import socket
import struct
import time

from support import HilTest, SimulatedGpio

CAN_FRAME = struct.Struct("=IB3x8s")


class SmokeTest(HilTest):
    def test_can_frames_come_from_one_socket_to_another(self):
        sockets = []
        for _ in range(2):
            bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
            self.addCleanup(bus.close)
            bus.bind(("vcan0",))
            bus.settimeout(5)
            sockets.append(bus)
        for identifier in (0x123, 0x1FFFFFFF | socket.CAN_EFF_FLAG):
            frame = CAN_FRAME.pack(identifier, 4, b"\xde\xad\xbe\xef")
            sockets[0].send(frame)
            self.assertEqual(sockets[1].recv(16), frame)

    def test_gpio_edges_are_seen(self):
        gpio = SimulatedGpio("smoke", ["a", "b"])
        self.addCleanup(gpio.remove)
        with open(self.path("edges"), "w", encoding="ascii") as edges:
            monitor = self.start("gpiomon", "--num-events=2", gpio.chip, "1", stdout=edges)
            time.sleep(0.5)
            gpio.set_level("b", True)
            gpio.set_level("b", False)
            self.assertEqual(monitor.wait(timeout=10), 0)
        with open(self.path("edges"), encoding="ascii") as edges:
            lines = edges.read().splitlines()
        self.assertIn("RISING", lines[0])
        self.assertIn("FALLING", lines[1])
