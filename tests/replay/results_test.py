"""tools/results on simulated drives that lie where recorded logs are looked for: its figures are those of the runs, what has run is
kept, and what is missing or wrong is said.

    results_test.py FOLDER_OF_THE_PROGRAMS
"""

import glob
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

PROJECT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../..")
sys.path.insert(0, os.path.join(PROJECT, "tests/conventions"))
import figures  # there

PROGRAMS = sys.argv.pop()
WORLD = ("room 0 0  8 6\nbox 2 2.5  1 0.5\nbox 4.5 4  0.5 1\npillar 6 2.5 0.2\nspeed 0.5\nturn_rate 60\ngo 1 1  5 1\n")


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, **options)


class ResultsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        world, log = self.path("room.world"), self.path("room.log")
        with open(world, "w", encoding="utf-8") as file:
            file.write(WORLD)
        self.odoless("sim", world, "--out", log, "--truth", self.path("room.tum"))
        os.mkdir(self.path("data"))
        for name, source in (("dwing-loop5.log", log), ("dwing-dpslam-with-odometry.tum", self.path("room.tum")), ("fr079.clf", log)):
            self.pack(name, source)
        with open(self.path("relations"), "w", encoding="utf-8") as file:
            file.write(self.relations())
        self.pack("fr079.relations", self.path("relations"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def pack(self, name, source):
        with open(self.path(f"data/{name}.xz"), "wb") as file:
            subprocess.run(["xz", "-c0", source], stdout=file, check=True)

    def relations(self):
        """Each true pose in the frame of the fifth before it."""
        with open(self.path("room.tum"), encoding="utf-8") as file:
            rows = [[float(word) for word in line.split()] for line in file if not line.startswith("#")]
        poses = [(row[0], row[1], row[2], 2.0 * math.atan2(row[6], row[7])) for row in rows]
        text = ""
        for (t1, x1, y1, yaw1), (t2, x2, y2, yaw2) in zip(poses, poses[5:]):
            c, s, dx, dy = math.cos(yaw1), math.sin(yaw1), x2 - x1, y2 - y1
            turn = math.remainder(yaw2 - yaw1, 2.0 * math.pi)
            text += f"{t1:.6f} {t2:.6f} {c * dx + s * dy:.6f} {c * dy - s * dx:.6f} 0 0 0 {turn:.6f}\n"
        return text

    def odoless(self, *command):
        done = run(os.path.join(PROGRAMS, "odoless"), *command)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def results(self, *names, seeds=1, more=()):
        return run(os.path.join(PROJECT, "tools/results"), "--programs", PROGRAMS, "--seeds", str(seeds), "--keep", self.path("kept"), "--out",
                   self.path("results.md"), *more, "--only", *names, env={**os.environ, "ODOLESS_DATA": self.path("data")})

    def written(self):
        with open(self.path("results.md"), encoding="utf-8") as file:
            return figures.measured(file.read())

    def test_figures_are_those_of_the_run(self):
        done = self.results("D-Wing", "Freiburg 079")
        self.assertEqual(done.returncode, 0, done.stderr)
        known = self.written()
        out = self.path("out")
        self.odoless("replay", self.path("data/fr079.clf.xz"), "--out", out)
        for log, metric, reference, kind in (("Freiburg 079", "relations", "fr079.relations.xz", "mean"),
                                             ("D-Wing", "ate", "dwing-dpslam-with-odometry.tum.xz", "rmse")):
            for column, file in (("final path", "trajectory.tum"), ("online path", "trajectory_online.tum")):
                errors = json.loads(self.odoless("eval", metric, "--json", self.path("data/" + reference), os.path.join(out, file)))
                cell = f"{errors['translation_m'][kind]:.3f} m, {errors['rotation_deg'][kind]:.2f} deg"
                self.assertEqual(known[log, column + ", median"], cell)
                self.assertLess(errors["translation_m"][kind], 0.05)
            self.assertEqual((known[log, "lost, worst"], known[log, "seeds"]), ("0", "1"))
        self.assertEqual(known["Freiburg 079", "of these off, worst"], "0")
        self.assertEqual(known["Freiburg 079", "of one visit"], str(self.relations().count("\n")))

    def test_what_has_run_is_kept_and_more_seeds_are_added(self):
        self.assertEqual(self.results("D-Wing").returncode, 0)
        kept, = glob.glob(self.path("kept/*/D-Wing, seed 1.json"))
        with open(kept, encoding="utf-8") as file:
            first = json.load(file)
        first["summary"]["lost_scans"] = 4000
        with open(kept, "w", encoding="utf-8") as file:
            json.dump(first, file)
        self.assertEqual(self.results("D-Wing", "Freiburg 079", seeds=2, more=["--kept"]).returncode, 0)
        self.assertEqual((self.written()["D-Wing", "seeds"], self.written()["D-Wing", "lost, median"]), ("1", "4000"))
        self.assertNotIn(("Freiburg 079", "seeds"), self.written())
        done = self.results("D-Wing", seeds=2)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.written()["D-Wing", "lost, median"], self.written()["D-Wing", "lost, worst"]), ("2000", "4000"))

    def test_what_is_missing_or_wrong_is_said_and_nothing_is_written(self):
        missing = self.results("D-Wing", "ACES")
        self.assertEqual(missing.returncode, 66)
        self.assertIn("aces.clf.xz: ODOLESS_DATA must be the folder", missing.stderr)
        with open(self.path("relations"), "w", encoding="utf-8") as file:
            file.write("1 2 3\n")
        self.pack("fr079.relations", self.path("relations"))
        wrong = self.results("Freiburg 079")
        self.assertEqual(wrong.returncode, 65)
        self.assertIn("this is no relation", wrong.stderr)
        self.assertIn("expected one of: Freiburg 079; ACES", self.results("Elsewhere").stderr)
        self.assertFalse(os.path.exists(self.path("results.md")))


if __name__ == "__main__":
    unittest.main()
