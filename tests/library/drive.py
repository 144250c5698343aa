"""A drive through a room of 10 m by 8 m with a pillar and a niche: scans by exact geometry, and the true poses."""

import math
import random

BEAMS = 180
START_RAD, STEP_RAD = -math.pi, 2 * math.pi / BEAMS
PERIOD_S = 0.1
WALLS = [((-5, -4), (5, -4)), ((5, -4), (5, 1)), ((5, 1), (7, 1)), ((7, 1), (7, 2)), ((7, 2), (5, 2)), ((5, 2), (5, 4)),
         ((5, 4), (-5, 4)), ((-5, 4), (-5, -4)), ((-2, 1), (-1, 1)), ((-1, 1), (-1, 2)), ((-1, 2), (-2, 2)), ((-2, 2), (-2, 1))]


def range_m(x, y, angle):
    """Distance to the nearest wall."""
    c, s = math.cos(angle), math.sin(angle)
    nearest = math.inf
    for (ax, ay), (bx, by) in WALLS:
        ex, ey = bx - ax, by - ay
        across = c * ey - s * ex
        if abs(across) < 1e-12:
            continue
        along = ((ax - x) * ey - (ay - y) * ex) / across
        share = ((ax - x) * s - (ay - y) * c) / across
        if along > 0 and 0 <= share <= 1:
            nearest = min(nearest, along)
    return nearest


def poses(scans):
    """On a circle of 1.5 m, at 0.75 m/s."""
    for i in range(scans):
        angle = 0.05 * i
        yield 1.5 * math.sin(angle) + 1.0, -1.5 * math.cos(angle) - 0.5, angle


def ranges_of(pose, chance):
    x, y, yaw = pose
    return [range_m(x, y, yaw + START_RAD + k * STEP_RAD) + chance.gauss(0, 0.005) for k in range(BEAMS)]


def scans(count, seed=1):
    """(stamp_s, ranges_m) of each scan."""
    chance = random.Random(seed)
    return [(PERIOD_S * i, ranges_of(pose, chance)) for i, pose in enumerate(poses(count))]


def lines(count):
    """As the examples read them."""
    return "".join(f"scan,{stamp:.3f},{START_RAD:.9f},{STEP_RAD:.9f},," + ",".join(f"{r:.4f}" for r in ranges) + "\n"
                   for stamp, ranges in scans(count))


def errors_m(found, count):
    """Distances of found (x, y) to the true ones, both in the frame of the first pose."""
    x0, y0, yaw0 = next(poses(1))
    c, s = math.cos(yaw0), math.sin(yaw0)
    for (x, y, _), (found_x, found_y) in zip(poses(count), found):
        dx, dy = x - x0, y - y0
        yield math.hypot(c * dx + s * dy - found_x, c * dy - s * dx - found_y)
