"""A servo drive written from CiA 301 and CiA 402 alone, with python3-can: what a daemon's servo may be, and none of its code."""

import struct
import threading
import time

import can

SPEED_CPS = 8000  # counts per second
MOVE_S = 0.02
VALUES = {(0x1000, 0): 0x00020192, (0x6040, 0): 0, (0x6060, 0): 0, (0x6064, 0): 0, (0x606C, 0): 0, (0x607A, 0): 0, (0x6502, 0): 1,
          (0x1017, 0): 0, (0x6041, 0): 0x40, (0x6061, 0): 0}
NO_OBJECT = 0x06020000


class ForeignDrive:
    """In profile position mode alone. `refused`: abort codes by (index, sub-index) of what it does not let itself be told."""

    def __init__(self, interface, refused, node=1):
        self.node = node
        self.refused = refused
        self.refusals = set()  # that somebody was given
        self.bus = can.Bus(channel=interface, interface="socketcan")
        self.ending = threading.Event()
        self.boot()
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def end(self):
        self.ending.set()
        self.thread.join()
        self.bus.shutdown()

    def position(self):
        return self.objects[0x6064, 0]

    def boot(self):
        self.objects = dict(VALUES)
        self.target = 0
        self.is_operational = False
        self.beats_at_s = self.moves_at_s = time.monotonic()
        self.send(0x700, b"\0")

    def send(self, function, data):
        self.bus.send(can.Message(arbitration_id=function + self.node, data=data, is_extended_id=False))

    def run(self):
        while not self.ending.is_set():
            frame = self.bus.recv(0.01)
            if frame:
                self.receive(frame.arbitration_id, bytes(frame.data))
            while time.monotonic() >= self.moves_at_s:
                self.moves_at_s += MOVE_S
                self.move()
            period_s = 1e-3 * self.objects[0x1017, 0]
            if period_s and time.monotonic() >= self.beats_at_s:
                self.beats_at_s = time.monotonic() + period_s
                self.send(0x700, b"\x05" if self.is_operational else b"\x7f")

    def receive(self, cob, data):
        if cob == 0 and len(data) == 2 and data[1] in (0, self.node):
            if data[0] in (0x81, 0x82):
                self.boot()
            else:
                self.is_operational = data[0] == 0x01
        elif cob == 0x600 + self.node and len(data) == 8:
            self.answer(data)
        elif cob == 0x80 and self.is_operational:
            self.send_pdo(0)
            self.send_pdo(1)
        elif cob == self.objects.get((0x1400, 1), 0) and self.is_operational:
            self.take_pdo(data)

    def answer(self, data):
        command, index, sub = struct.unpack("<BHB", data[:4])
        if command >> 5 == 1:
            self.answer_write(command, (index, sub), data)
        elif command >> 5 == 2:
            value = self.objects.get((index, sub))
            if value is None:
                self.send(0x580, struct.pack("<BHBI", 0x80, index, sub, NO_OBJECT))
            else:
                self.send(0x580, struct.pack("<BHBI", 0x43, index, sub, value & 0xFFFFFFFF))

    def answer_write(self, command, key, data):
        if key in self.refused:
            self.refusals.add(key)
            self.send(0x580, struct.pack("<BHBI", 0x80, *key, self.refused[key]))
            return
        size = 4 - (command >> 2 & 3)
        self.write(key, int.from_bytes(data[4:4 + size], "little", signed=key[0] >= 0x6000))
        self.send(0x580, struct.pack("<BHBI", 0x60, *key, 0))

    def write(self, key, value):
        self.objects[key] = value
        if key == (0x6040, 0):
            self.obey(value)
        if key == (0x6060, 0):
            self.objects[0x6061, 0] = value

    def obey(self, control):
        """The state machine of the power drive system, of which a drive without faults has these states."""
        state = self.objects[0x6041, 0] & 0x6F
        if control & 0x82 == 0:
            state = 0x40
        elif control & 0x87 == 0x06:
            state = 0x21
        elif control & 0x86 == 0x02:
            state = 0x07 if state == 0x27 else 0x40
        elif control & 0x8F == 0x07 and state in (0x21, 0x27):
            state = 0x23
        elif control & 0x8F == 0x0F and state in (0x21, 0x23, 0x07):
            state = 0x27
        acknowledged = 0x1000 if control & 0x10 and state == 0x27 else 0
        if acknowledged:
            self.target = self.objects[0x607A, 0]
        self.objects[0x6041, 0] = state | acknowledged | self.objects[0x6041, 0] & 0x400

    def move(self):
        if self.objects[0x6041, 0] & 0x6F == 0x27:
            step = int(SPEED_CPS * MOVE_S)
            self.objects[0x6064, 0] += max(-step, min(step, self.target - self.position()))
        is_there = self.position() == self.target
        self.objects[0x6041, 0] = self.objects[0x6041, 0] & ~0x400 | (0x400 if is_there else 0)

    def mapping(self, index):
        """(index, sub-index), bytes of each entry."""
        entries = [self.objects.get((index, i + 1), 0) for i in range(self.objects.get((index, 0), 0))]
        return [((entry >> 16 & 0xFFFF, entry >> 8 & 0xFF), (entry & 0xFF) // 8) for entry in entries]

    def send_pdo(self, number):
        cob = self.objects.get((0x1800 + number, 1), 1 << 31)
        if cob >> 31 == 0:
            data = b"".join((self.objects.get(key, 0) & (1 << 8 * size) - 1).to_bytes(size, "little")
                            for key, size in self.mapping(0x1A00 + number))
            self.send((cob & 0x7FF) - self.node, data)

    def take_pdo(self, data):
        taken = []
        for key, size in self.mapping(0x1600):
            taken.append((key, int.from_bytes(data[:size], "little", signed=key == (0x607A, 0))))
            data = data[size:]
        for key, value in sorted(taken, reverse=True):  # the set point before the control word that takes it
            self.write(key, value)
