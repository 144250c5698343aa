"""Where an emulated laser truly was, and how far from there a daemon says that it is."""

import bisect
import math

from support import poses


def relative(a, b):
    """a_T_b of two poses in one frame."""
    c, s = math.cos(a[2]), math.sin(a[2])
    x_m, y_m = b[0] - a[0], b[1] - a[1]
    return c * x_m + s * y_m, -s * x_m + c * y_m, math.remainder(b[2] - a[2], 2.0 * math.pi)


class Truth:
    def __init__(self, path):
        self.poses = poses(path)
        self.stamps_us = sorted(self.poses)

    def at(self, stamp_us):
        after = min(bisect.bisect_left(self.stamps_us, stamp_us), len(self.stamps_us) - 1)
        before = max(0, after - 1)
        nearest = min((self.stamps_us[before], self.stamps_us[after]), key=lambda us: abs(us - stamp_us))
        return self.poses[nearest]

    def off(self, start_us, stamp_us, pose):
        """(m, deg) between a pose in the frame of where the laser was at `start_us`, and where it was at `stamp_us`."""
        x_m, y_m, yaw_rad = relative(relative(self.at(start_us), self.at(stamp_us)), pose)
        return math.hypot(x_m, y_m), abs(math.degrees(yaw_rad))
