"""odoless inside of another project: only the libraries that it asks for are made; core is without exceptions and run-time types, and needs
nothing but the C and C++ libraries. The examples are right.

    embedded_test.py FOLDER_OF_THE_BUILD FOLDER_TO_BUILD_IN
"""

import os
import re
import shutil
import subprocess
import sys
import unittest

import drive
from command import run

HERE = os.path.dirname(os.path.realpath(__file__))
SYSTEM = {"libc.so.6", "libm.so.6", "libstdc++.so.6", "libgcc_s.so.1", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
EXAMPLES = os.path.join(HERE, "../../tools/examples")


class EmbeddedTest(unittest.TestCase):
    folder = ""

    @classmethod
    def setUpClass(cls):
        cache = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        run("cmake", "-G", "Ninja", "-S", os.path.join(HERE, "embedded"), "-B", cls.folder, "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
            "-DPython_EXECUTABLE=" + sys.executable, *cache)
        run("cmake", "--build", cls.folder)

    def program(self, name):
        return os.path.join(self.folder, "examples", name)

    def test_only_the_libraries_that_are_asked_for_are_made(self):
        made = run("cmake", "--build", self.folder, "--target", "help")
        self.assertIn("odoless_core", made)
        for other in ("odoless_drivers", "odoless_firmware", "odoless_tools", "odolessd", "test_core"):
            self.assertIsNone(re.search(rf"\b{other}\b", made), other)

    def test_core_needs_the_c_and_cpp_libraries_alone(self):
        for name in ("match_two_scans", "slam_from_csv"):
            needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "--dynamic", self.program(name))))
            self.assertLessEqual(needed, SYSTEM, name)

    def test_core_has_neither_exceptions_nor_run_time_types(self):
        symbols = run("nm", "-C", os.path.join(self.folder, "odoless/core/libodoless_core.a"))
        self.assertNotIn("__cxa_throw", symbols)
        self.assertNotIn("typeinfo for odoless", symbols)

    def test_a_program_may_define_what_a_broken_invariant_does(self):
        outcome = subprocess.run([os.path.join(self.folder, "own_check")], capture_output=True, text=True, check=False)
        self.assertEqual((outcome.returncode, outcome.stderr), (42, ""))

    def test_examples_are_short(self):
        for name in os.listdir(EXAMPLES):
            with open(os.path.join(EXAMPLES, name), encoding="utf-8") as file:
                self.assertLessEqual(len(file.readlines()), 60, name)

    def test_two_scans_are_matched(self):
        first, *_, last = drive.lines(11).splitlines(keepends=True)
        motion, _, verdict = run(self.program("match_two_scans"), input=first + last).splitlines()
        x, y = (float(number) for number in re.findall(r"(-?[\d.]+) m\b", motion))
        error = list(drive.errors_m([(0, 0)] * 10 + [(x, y)], 11))[-1]
        self.assertLess(error, 0.02, motion)
        self.assertTrue(verdict.startswith("converged"), verdict)

    def test_a_drive_is_followed(self):
        said = run(self.program("slam_from_csv"), input=drive.lines(100))
        found = [tuple(float(number) for number in line.split()[1:3]) for line in said.splitlines()]
        self.assertEqual(len(found), 100)
        self.assertLess(max(drive.errors_m(found, 100)), 0.05)

    def in_block(self, megabytes):
        return subprocess.run([os.path.join(self.folder, f"slam_in_{megabytes}_mb")], input=drive.lines(100), capture_output=True,
                              text=True, check=False)

    def test_a_drive_is_followed_in_a_block_of_memory_that_the_program_brings(self):
        outcome = self.in_block(128)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertEqual(outcome.stdout, run(self.program("slam_from_csv"), input=drive.lines(100)))
        taken = int(re.fullmatch(r"(\d+) of 128000000 bytes taken\n", outcome.stderr).group(1))
        self.assertGreater(taken, 90e6)
        self.assertLess(taken, 100e6)

    def test_a_block_that_is_too_small_is_seen_at_once(self):
        outcome = self.in_block(4)
        self.assertEqual((outcome.returncode, outcome.stdout), (71, ""))
        self.assertRegex(outcome.stderr, r"of 4000000 bytes taken, and more are asked for$")

    def test_what_is_no_scan_is_refused(self):
        for text in ("", "scan\n", "scan,x,0,0.1,,1\nscan,1,0,0.1,,1\n", "scan,1,0,0,,1\nscan,1,0,0,,1\n"):
            outcome = subprocess.run([self.program("match_two_scans")], input=text, capture_output=True, text=True, check=False)
            self.assertEqual(outcome.returncode, 65, text)
            self.assertIn("match_two_scans: ", outcome.stderr)


if __name__ == "__main__":
    EmbeddedTest.folder = sys.argv.pop()
    sys.argv.pop()
    unittest.main()
