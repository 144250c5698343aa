"""A serial line between the daemon and its laser that can be told to spoil what it carries."""

import os
import pty
import random
import select
import threading
import tty


class SpoiltLine:
    """Carries bytes both ways between the device at `device` and whoever opens `link`, until it is ended."""

    GARBAGE = random.Random(1).randbytes(4096)

    def __init__(self, device, link):
        self.garbage = False
        self._device = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self._own, self._far = pty.openpty()
        for end in (self._device, self._far):
            tty.setraw(end)
        os.set_blocking(self._own, False)
        os.symlink(os.ttyname(self._far), link)
        self._over = threading.Event()
        self._carrier = threading.Thread(target=self._carry, daemon=True)
        self._carrier.start()

    def end(self):
        self._over.set()
        self._carrier.join()
        for end in (self._device, self._own, self._far):
            os.close(end)

    def _carry(self):
        while not self._over.is_set():
            ready, _, _ = select.select([self._device, self._own], [], [], 0.0005 if self.garbage else 0.05)
            try:
                if self._device in ready:
                    data = os.read(self._device, 65536)
                    if not self.garbage:
                        os.write(self._own, data)
                if self._own in ready:
                    os.write(self._device, os.read(self._own, 65536))
                if self.garbage:
                    os.write(self._own, self.GARBAGE)
            except BlockingIOError:
                pass  # who does not read loses bytes, as on a line
            except OSError:
                return  # the device is gone
