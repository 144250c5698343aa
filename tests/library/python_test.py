"""The Python module: a drive as arrays gives its trajectory, the same one each time; wrong arrays are refused with a sentence.

    python_test.py FOLDER_OF_THE_BUILD FOLDER_OF_THE_MODULE'S_BUILD
"""

import os
import sys
import unittest

import numpy

import drive

SCANS = 100


def laser():
    return odoless.Laser(drive.START_RAD, drive.STEP_RAD)


class PythonTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        stamps, ranges = zip(*drive.scans(SCANS))
        cls.stamps, cls.ranges = numpy.array(stamps), numpy.array(ranges)

    def test_a_drive_is_followed(self):
        final, online = odoless.replay(self.stamps, self.ranges, laser())
        for found in (final, online):
            self.assertEqual(found.shape, (SCANS, 3))
            self.assertLess(max(drive.errors_m(found[:, :2], SCANS)), 0.05)

    def test_the_same_arrays_give_the_same_numbers(self):
        once, _ = odoless.replay(self.stamps[:30], self.ranges[:30].astype("float32"), laser(), seed=7)
        again, _ = odoless.replay(self.stamps[:30], self.ranges[:30], laser(), seed=7)
        numpy.testing.assert_array_equal(once, again)

    def test_a_configuration_is_taken(self):
        near, _ = odoless.replay(self.stamps[:5], self.ranges[:5], laser(), config="[scan]\nrange_max_m = 0.5\n")
        numpy.testing.assert_array_equal(near, numpy.zeros((5, 3)))  # nothing is seen

    def test_wrong_arrays_are_refused(self):
        for stamps, ranges, what in (
            (self.stamps[:5], self.ranges[:6], "one stamp per row"),
            (self.stamps, self.ranges[0], "a row per scan"),
            (numpy.array([numpy.nan]), self.ranges[:1], "a stamp must be a number"),
            (self.stamps[:1], numpy.ones((1, 20000)), "too many beams"),
        ):
            with self.assertRaisesRegex(ValueError, what):
                odoless.replay(stamps, ranges, laser())
        with self.assertRaisesRegex(ValueError, "angle step of 0"):
            odoless.replay(self.stamps[:1], self.ranges[:1], odoless.Laser(0.0, 0.0))
        with self.assertRaisesRegex(ValueError, "unknown key 'scan.what'"):
            odoless.replay(self.stamps[:1], self.ranges[:1], laser(), config="[scan]\nwhat = 1\n")

    def test_no_scans_give_no_poses(self):
        final, online = odoless.replay(numpy.empty(0), numpy.empty((0, 180)), laser())
        self.assertEqual((final.shape, online.shape), ((0, 3), (0, 3)))


if __name__ == "__main__":
    sys.path.insert(0, os.path.join(sys.argv.pop(), "python"))
    sys.argv.pop()
    import odoless

    unittest.main()
