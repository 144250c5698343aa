"""A sample of the fault campaign: how often the daemon is sure of a wrong pose.

    sample_test.py PROGRAM_ODOLESS

The runs are seeded, so that the same program gives the same figures; `tools/campaign --runs 1000` is the whole.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

ODOLESS = sys.argv[1]
RUNS = 24  # the first that have every kind of fault; 2.8 s of CPU each
SILENT_MAX = 1  # of these, in which it is sure of a wrong pose (10); the aim is none, and whoever mends one lowers this


class SampleTest(unittest.TestCase):
    def test_is_not_sure_of_a_wrong_pose_more_often_than_is_known(self):
        with tempfile.TemporaryDirectory() as folder:
            report = os.path.join(folder, "campaign.json")
            done = subprocess.run([ODOLESS, "campaign", "--runs", str(RUNS), "--seed", "1", "--jobs", "1", "--json", report],
                                  stdout=subprocess.PIPE, text=True, check=False)
            print(done.stdout)
            with open(report, encoding="utf-8") as file:
                said = json.load(file)
        self.assertEqual(said["runs"], RUNS)
        self.assertEqual(done.returncode, 1 if said["silent_failures"] else 0)
        self.assertLessEqual(said["silent_failures"], SILENT_MAX)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
