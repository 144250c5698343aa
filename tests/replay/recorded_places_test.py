"""How soon a robot that is switched on somewhere in a recorded building knows where it is: the laser there has people, glass and clutter
before it, which no simulated room has.

    recorded_places_test.py FOLDER_OF_THE_PROGRAMS
"""

import os
import re
import subprocess
import sys
import tempfile
import unittest

ODOLESS = os.path.join(sys.argv.pop(), "odoless")
LOG = os.path.join(os.environ.get("ODOLESS_DATA", ""), "fr079.clf.xz")
PLACES = 16


class RecordedPlaces(unittest.TestCase):
    def test_a_robot_guesses_within_seconds_where_it_is_and_is_right(self):
        with tempfile.TemporaryDirectory() as folder:
            world, run = (os.path.join(folder, name) for name in ("world", "run"))
            subprocess.run([ODOLESS, "replay", LOG, "--out", run, "--world", world], check=True, capture_output=True)
            answer = subprocess.run([ODOLESS, "eval", "places", world, LOG, os.path.join(run, "trajectory.tum"), "--places", str(PLACES),
                                     "--watched-s", "10"], check=True, capture_output=True, text=True).stdout
        print(answer, file=sys.stderr)
        told, median_s = re.search(r"in (\d+) within 10 s of scans; after ([0-9.]+) s", answer).groups()
        wrong, guessed = re.search(r"guesses +(\d+) of (\d+) scans wrong", answer).groups()
        self.assertGreaterEqual(int(told), 0.9 * PLACES)
        self.assertLess(float(median_s), 1.0)
        self.assertGreater(int(guessed), 300)
        self.assertEqual(int(wrong), 0)


if __name__ == "__main__":
    if not os.path.exists(LOG):
        sys.exit("skipped: ODOLESS_DATA has no fr079.clf.xz")
    unittest.main(verbosity=2)
