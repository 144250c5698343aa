"""The library for C, installed: C11 programs are compiled without a warning, with what pkg-config says; a drive has the path and the
map of `odoless replay`, and each wrong call its code.

    c_test.py FOLDER_OF_THE_BUILD FOLDER
"""

import os
import re
import shutil
import sys
import tempfile
import unittest

import drive
from command import run

HERE = os.path.dirname(os.path.realpath(__file__))
SCANS = 60
STRICT = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]


class CTest(unittest.TestCase):
    build = ""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        prefix = os.path.join(cls.folder, "prefix")
        run("cmake", "--install", cls.build, "--component", "dev", "--prefix", prefix)
        config = next(os.path.join(path, "") for path, _, files in os.walk(prefix) if "odoless-c.pc" in files)
        cls.flags = run("pkg-config", "--cflags", "--libs", "odoless-c", env={**os.environ, "PKG_CONFIG_PATH": config}).split()

    def compiled(self, source):
        program = os.path.join(self.folder, os.path.basename(source)[:-2])
        run("cc", *STRICT, source, "-o", program, *self.flags)
        return program

    def replayed(self, lines):
        """Rows of the trajectory and the first words of the map, as the command has them."""
        log, out = os.path.join(self.folder, "drive.csv"), os.path.join(self.folder, "out")
        with open(log, "w", encoding="utf-8") as file:
            for line in lines.splitlines():
                _, stamp, start, step, _, *ranges = line.split(",")
                file.write(",".join([stamp, start, step, "0", "0.1", "0.05", "30", str(len(ranges)), *ranges]) + "\n")
        run(os.path.join(self.build, "bin/odoless"), "replay", log, "--out", out)
        with open(os.path.join(out, "trajectory.tum"), encoding="utf-8") as file:
            rows = [line.split() for line in file]
        with open(os.path.join(out, "map.pgm"), "rb") as file:
            size = [int(word) for word in re.findall(rb"\d+", file.read(100))[1:3]]
        return rows, size

    def test_a_drive_has_the_path_and_map_of_the_command(self):
        lines = drive.lines(SCANS)
        *poses, about_map = run(self.compiled(os.path.join(HERE, "../../tools/examples/slam.c")), input=lines).splitlines()
        rows, size = self.replayed(lines)
        self.assertEqual([pose.split()[:3] for pose in poses], [row[:3] for row in rows])
        found = [tuple(float(word) for word in pose.split()[1:3]) for pose in poses]
        self.assertLess(max(drive.errors_m(found, SCANS)), 0.05)
        self.assertEqual(about_map, f"map: {size[0]} x {size[1]} cells of 0.05 m")

    def test_each_wrong_call_has_its_code(self):
        run(self.compiled(os.path.join(HERE, "c_calls.c")))


if __name__ == "__main__":
    sys.argv.pop()
    CTest.build = sys.argv.pop()
    unittest.main()
