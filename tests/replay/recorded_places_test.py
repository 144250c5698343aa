"""How soon a robot that is switched on somewhere in a recorded building knows where it is: the laser there has people, glass and clutter
before it, which no simulated room has.

    recorded_places_test.py FOLDER_OF_THE_PROGRAMS
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import unittest

ODOLESS = os.path.join(sys.argv.pop(), "odoless")
LOG = os.path.join(os.environ.get("ODOLESS_DATA", ""), "fr079.clf.xz")
PLACES = 16


class RecordedPlaces(unittest.TestCase):
    def test_a_robot_knows_within_seconds_where_it_is_and_is_never_wrong(self):
        with tempfile.TemporaryDirectory() as folder:
            world, run = (os.path.join(folder, name) for name in ("world", "run"))
            subprocess.run([ODOLESS, "replay", LOG, "--out", run, "--world", world], check=True, capture_output=True)
            answer = subprocess.run([ODOLESS, "eval", "places", world, LOG, os.path.join(run, "trajectory.tum"), "--places", str(PLACES),
                                     "--watched-s", "10", "--json"], check=True, capture_output=True, text=True)
        said = json.loads(answer.stdout)
        told_s = [place["told_after_s"] if place["told_after_s"] >= 0.0 else 10.0 for place in said["places"]]
        print(f"{said['told_in_time']} of {PLACES} after 10 s, {statistics.median(told_s):.1f} s (median)", file=sys.stderr)
        self.assertEqual(said["wrong"], 0)
        self.assertGreaterEqual(said["told_in_time"], 0.9 * PLACES)
        self.assertLess(statistics.median(told_s), 3.0)


if __name__ == "__main__":
    if not os.path.exists(LOG):
        sys.exit("skipped: ODOLESS_DATA has no fr079.clf.xz")
    unittest.main(verbosity=2)
