"""Recorded bytes of a whole robot, played into the unmodified daemon through the devices' lines.

    raw_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES
"""

import math
import os
import signal
import struct
import subprocess
import sys
import unittest

from support import SOURCES, WORLD, DaemonCase, poses, run

sys.path.append(os.path.join(SOURCES, "tests", "support"))
from lcm_log import messages  # noqa: E402

RUN_S = 6
SERVO_DATA_MIN = 30
NO_RETURN_M = 1000.0


def device_bytes(path):
    """All that the laser said."""
    return b"".join(data[20:] for channel, data in messages(path) if channel == "ODOLESS_LRF_RAW_RX")


def scans(path):
    """(stamp in s, ranges' bytes) of each scan, after the type's fingerprint."""
    return [(struct.unpack(">q", data[8:16])[0] * 1e-6, data[16:]) for channel, data in messages(path)
            if channel == "ODOLESS_SCAN"]


class RawTest(DaemonCase):
    def run_daemon(self, name, robot, seconds=None):
        """Until the robot ends, or for that time. Its recorder's log."""
        self.use_servo(f'[recorder]\npath = "{self.path(name)}"\n')
        daemon = self.start("odolessd", "--config", self.config, "--out", self.path(name))
        try:
            robot.wait(timeout=seconds or 30)
        except subprocess.TimeoutExpired:
            self.assertIsNotNone(seconds, "the record did not come to its end")
        self.assertIsNone(daemon.poll(), "the daemon ended by itself")
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=10), 0, daemon.stderr.read())
        return self.path(name + ".00000.lcm")

    def replayed(self, name, recorded):
        """The trajectory that `odoless replay` finds for these scans, with so many particles that a stamp which came 0.1 ms
        later does not decide where along a wall the robot is taken to be."""
        with open(self.path("many.toml"), "w", encoding="ascii") as file:
            file.write("[slam.low]\nparticles = 1000\nspread_error = 0.0\n")
        with open(self.path(name + ".csv"), "w", encoding="ascii") as log:
            for stamp_s, data in recorded:
                (beams,) = struct.unpack_from(">i", data)
                ranges_m = struct.unpack_from(f">{beams}f", data, 4)
                start_rad, step_rad = struct.unpack_from(">ff", data, 4 + 4 * beams + 4)
                values = ",".join(f"{min(range_m, NO_RETURN_M):.9g}" for range_m in ranges_m)
                log.write(f"{stamp_s:.6f},{start_rad:.9g},{step_rad:.9g},0,0,0,{NO_RETURN_M},{beams},{values}\n")
        outcome = run("odoless", "replay", self.path(name + ".csv"), "--config", self.path("many.toml"), "--out", self.path(name + "_replayed"))
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        return poses(self.path(name + "_replayed/trajectory_online.tum"))

    def lines(self):
        return "--pty", self.path("laser"), "--servo-pty", self.path("servo")

    def start_robot(self, *more):
        robot = self.start("odoless", "emulate", "robot", *more, *self.lines(), stdout=subprocess.PIPE)
        self.wait_until(lambda: os.path.lexists(self.path("laser")) and os.path.lexists(self.path("servo")), 10)
        return robot

    def test_a_recorded_robot_gives_the_same_scans_and_the_same_trajectory_again(self):
        robot = self.start_robot("--from", WORLD)
        log = self.run_daemon("first", robot, RUN_S)
        robot.send_signal(signal.SIGTERM)
        robot.wait(timeout=5)
        robot = self.start_robot("--from-raw", log, "--stop-at-end")
        log_again = self.run_daemon("second", robot)
        said = robot.stdout.read()
        self.assertIn("laser: ", said)

        again, before = device_bytes(log_again), device_bytes(log)
        self.assertTrue(before.startswith(again), "the laser's bytes are the recorded ones")
        self.assertGreater(len(again), 0.98 * len(before))
        first, second = scans(log), scans(log_again)
        stamps = {ranges: stamp_s for stamp_s, ranges in second}
        common = [(stamp_s, stamps[ranges]) for stamp_s, ranges in first if ranges in stamps]
        self.assertGreater(len(first), 100)
        # Bit for bit; a busy machine may leave out a scan, in either run, but never change one.
        self.assertGreater(len(common), 0.97 * max(len(first), len(second)))
        self.assertEqual([b for _, b in common], sorted(b for _, b in common), "in order")
        # The stamps come from the arrival of bytes, which the kernel's scheduling moves about; at first, nothing evens it.
        later_s = sorted(b - a for a, b in common[40:])
        shift_s = max(later_s[-1] - later_s[len(later_s) // 2], later_s[len(later_s) // 2] - later_s[0])
        # What the daemon computes live hangs on the processor's time besides, what a replay makes of its scans does not.
        path, path_again = self.replayed("first", first), self.replayed("second", second)
        apart = [(path[a], path_again[b]) for a, b in ((round(a * 1e6), round(b * 1e6)) for a, b in common)
                 if a in path and b in path_again]
        self.assertGreater(len(apart), 0.95 * len(common))
        apart_m = max(math.hypot(p[0] - q[0], p[1] - q[1]) for p, q in apart)
        apart_deg = max(abs(math.degrees(math.remainder(p[2] - q[2], 2.0 * math.pi))) for p, q in apart)
        moved_m = math.hypot(*(path[max(path)][i] - path[min(path)][i] for i in (0, 1)))
        print(f"raw replay: {len(again)} bytes of the laser and {len(common)} of {len(first)} scans equal to the bit, "
              f"stamps within {shift_s * 1e3:.2f} ms, {len(apart)} poses within {apart_m * 1e3:.1f} mm and "
              f"{apart_deg:.3f} deg after {moved_m:.1f} m; {said.strip()}")
        self.assertLess(apart_m, 0.05)
        self.assertLess(apart_deg, 1.0)
        self.assertGreater(moved_m, 1.0)
        self.assertGreater(sum(channel == "ODOLESS_TILT" for channel, _ in messages(log_again)), SERVO_DATA_MIN, "the servo's record was played, too")

    def test_a_log_without_bytes_is_refused(self):
        with open(self.path("empty.lcm"), "wb"):
            pass
        robot = self.start("odoless", "emulate", "robot", "--from-raw", self.path("empty.lcm"), *self.lines())
        self.assertEqual(robot.wait(timeout=10), 65)
        self.assertIn("no bytes of a laser", robot.stderr.read())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
