#!/usr/bin/env python3
"""Clients written from the vendors' manuals, with python3-serial, read our emulated lasers and move our emulated servos.

    serial_clients_test.py ODOLESS

They know nothing of our drivers: check sums, angles and units are made here anew.
"""

import math
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

try:
    import serial
except ImportError:
    print("skipped: python3-serial is not installed")
    sys.exit(0)

ODOLESS = sys.argv[1]
ROOM_M = (8.0, 5.0)
PLACE_M = (3.0, 2.0)
WRONG_MAX_M = 0.03
SECONDS_MAX = 20


def wall_m(angle_rad):
    """How far a wall of the room is, counter-clockwise from ahead."""
    x, y = math.cos(angle_rad), math.sin(angle_rad)
    ways = [((ROOM_M[axis] if d > 0 else 0.0) - PLACE_M[axis]) / d for axis, d in enumerate((x, y)) if abs(d) > 1e-9]
    return min(ways)


def crc8(data):
    """Polynomial 4Dh, of the LD06's manual."""
    value = 0
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value << 1 ^ 0x4D) & 0xFF if value & 0x80 else value << 1
    return value


def crc16(data):
    """Polynomial 8005h, of ROBOTIS' e-manual."""
    value = 0
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = (value << 1 ^ 0x8005) & 0xFFFF if value & 0x8000 else value << 1
    return value


class SerialClients(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.link = os.path.join(self.folder, "line")

    def start(self, *arguments):
        device = subprocess.Popen([ODOLESS, "emulate", *arguments], stdout=subprocess.PIPE, text=True)
        self.addCleanup(device.communicate)
        self.addCleanup(device.kill)
        return device

    def start_laser(self, model, *line):
        world = os.path.join(self.folder, "room.world")
        with open(world, "w", encoding="ascii") as file:
            file.write("room 0 0  {} {}\nspeed 0.01\ngo {} {}  3.01 2\n".format(*ROOM_M, *PLACE_M))
        return self.start("lrf", "--model", model, "--from", world, "--noise-sd-m", "0", *line)

    def open(self, baud):
        end_s = time.monotonic() + SECONDS_MAX
        while not os.path.lexists(self.link) and time.monotonic() < end_s:
            time.sleep(0.01)
        line = serial.Serial(self.link, baud, timeout=2)
        self.addCleanup(line.close)
        return line

    def expect_the_room(self, points):
        """Of angle (counter-clockwise, rad) and range (m)."""
        seen = [(angle, range_m) for angle, range_m in points if range_m > 0.0]
        self.assertGreater(len(seen), 0.9 * len(points))
        right = [abs(range_m - wall_m(angle)) < WRONG_MAX_M for angle, range_m in seen]
        self.assertGreater(sum(right), 0.97 * len(right))
        bearings = [math.cos(angle) for angle, _ in points]
        self.assertGreater(max(bearings) - min(bearings), 1.6, "most of the circle was seen")

    def test_an_ld06(self):
        self.start_laser("ld06", "--pty", self.link)
        line = self.open(230400)
        points = []
        while len(points) < 600:
            while line.read(1) != b"\x54" or line.read(1) != b"\x2c":
                pass
            packet = b"\x54\x2c" + line.read(45)
            if crc8(packet[:-1]) != packet[-1]:
                continue
            first, last = (struct.unpack_from("<H", packet, at)[0] * 0.01 for at in (4, 42))
            for i in range(12):
                clockwise = first + (last - first) % 360.0 * i / 11
                points.append((-math.radians(clockwise), struct.unpack_from("<H", packet, 6 + 3 * i)[0] * 1e-3))
        self.expect_the_room(points)

    def test_a_ydlidar_x4(self):
        self.start_laser("ydlidar-x4", "--pty", self.link)
        line = self.open(128000)
        line.write(b"\xa5\x60")
        self.assertEqual(line.read(7), b"\xa5\x5a\x05\x00\x00\x40\x81")
        points = []
        while len(points) < 900:
            while line.read(1) != b"\xaa" or line.read(1) != b"\x55":
                pass
            head = line.read(8)
            count = head[1]
            first, last, told = struct.unpack_from("<HHH", head, 2)
            samples = struct.unpack(f"<{count}H", line.read(2 * count))
            word = 0x55AA ^ (head[0] | count << 8) ^ first ^ last
            for sample in samples:
                word ^= sample
            self.assertEqual(word, told)
            first, last = (first >> 1) / 64.0, (last >> 1) / 64.0
            for i, sample in enumerate(samples):
                mm = sample / 4.0
                clockwise = first + ((last - first) % 360.0 * i / (count - 1) if count > 1 else 0.0)
                if mm > 0.0:
                    clockwise += math.degrees(math.atan(21.8 * (155.3 - mm) / (155.3 * mm)))
                points.append((-math.radians(clockwise), mm * 1e-3))
        self.expect_the_room(points)

    def test_an_rplidar_c1_by_its_standard_scan(self):
        self.start_laser("rplidar-c1", "--pty", self.link)
        line = self.open(460800)
        line.write(b"\xa5\x20")
        self.assertEqual(line.read(7), b"\xa5\x5a\x05\x00\x00\x40\x81")
        points = []
        while len(points) < 800:
            node = line.read(5)
            self.assertNotEqual(node[0] & 1, node[0] >> 1 & 1, "start and its inverse")
            self.assertEqual(node[1] & 1, 1, "the check bit")
            clockwise, mm = (node[1] >> 1 | node[2] << 7) / 64.0, (node[3] | node[4] << 8) / 4.0
            points.append((-math.radians(clockwise), mm * 1e-3))
        self.expect_the_room(points)

    def test_a_tim571_in_cola_b(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        laser = self.start_laser("tim571", "--tcp", str(port))
        laser.stdout.readline()
        line = socket.create_connection(("127.0.0.1", port), SECONDS_MAX)
        self.addCleanup(line.close)
        text = b"sRN LMDscandata"
        total = 0
        for byte in text:
            total ^= byte
        line.sendall(b"\x02" * 4 + struct.pack(">I", len(text)) + text + bytes([total]))
        head = line.recv(8, socket.MSG_WAITALL)
        self.assertEqual(head[:4], b"\x02" * 4)
        content = line.recv(struct.unpack(">I", head[4:])[0], socket.MSG_WAITALL)
        self.assertTrue(content.startswith(b"sRA LMDscandata "))
        at = content.index(b"DIST1") + 5
        scale, offset, start, step, count = struct.unpack_from(">ffiHH", content, at)
        self.assertEqual((scale, offset, count), (1.0, 0.0, 811))
        counts = struct.unpack_from(f">{count}H", content, at + 16)
        self.assertEqual(step, 3333)
        self.expect_the_room([(math.radians(start * 1e-4 + i / 3.0 - 90.0), mm * 1e-3) for i, mm in enumerate(counts)])

    def ask_dynamixel(self, line, instruction, parameters=b""):
        packet = b"\xff\xff\xfd\x00\x01" + struct.pack("<HB", len(parameters) + 3, instruction) + parameters
        line.write(packet + struct.pack("<H", crc16(packet)))
        head = line.read(7)
        self.assertEqual(head[:5], b"\xff\xff\xfd\x00\x01")
        rest = line.read(struct.unpack("<H", head[5:])[0])
        self.assertEqual(crc16(head + rest[:-2]), struct.unpack("<H", rest[-2:])[0])
        self.assertEqual(rest[:2], b"\x55\x00", "a status without an error")
        return rest[2:-2]

    def test_a_dynamixel_is_found_and_goes_where_it_is_told(self):
        self.start("servo", "--dynamixel", "--pty", self.link)
        line = self.open(57600)
        self.assertEqual(struct.unpack_from("<H", self.ask_dynamixel(line, 1))[0], 1020, "an XM430-W350")
        for address, value, form in ((11, 3, "<HB"), (64, 1, "<HB"), (116, 2500, "<HI")):
            self.ask_dynamixel(line, 3, struct.pack(form, address, value))
        end_s = time.monotonic() + SECONDS_MAX
        position = None
        while position is None or (abs(position - 2500) > 5 and time.monotonic() < end_s):
            (position,) = struct.unpack("<i", self.ask_dynamixel(line, 2, struct.pack("<HH", 132, 4)))
        self.assertLessEqual(abs(position - 2500), 5)

    def test_a_maestro_makes_the_pulse_it_is_told(self):
        self.start("servo", "--maestro", "--pty", self.link)
        line = self.open(9600)
        line.write(b"\xa1")
        self.assertEqual(line.read(2), b"\x00\x00", "no errors")
        line.write(bytes([0x84, 0, 6400 & 0x7F, 6400 >> 7]))
        line.write(b"\x90\x00")
        self.assertEqual(struct.unpack("<H", line.read(2))[0], 6400)
        line.write(bytes([0x87, 0, 10, 0]))  # slowly
        line.write(bytes([0x84, 0, 5600 & 0x7F, 5600 >> 7]))
        line.write(b"\x93")
        self.assertEqual(line.read(1), b"\x01", "it moves")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
