"""tools/mutants: which errors it plants, that it finds out which tests catch them, and that it leaves sources and build alone.

    mutants_test.py BUILT_TREE
"""

import importlib.machinery
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import unittest

PROJECT = os.path.realpath(os.path.join(os.path.dirname(__file__), "../.."))
TOOL = os.path.join(PROJECT, "tools/mutants")
FILE = "drivers/lrf/scip/number.cpp"
BUILD = sys.argv.pop()


def load():
    loader = importlib.machinery.SourceFileLoader("mutants", TOOL)
    spec = importlib.util.spec_from_loader("mutants", loader)
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def contents(path):
    with open(path, "rb") as file:
        return file.read()


def trial(*options):
    with tempfile.TemporaryDirectory() as folder:
        found = os.path.join(folder, "errors.json")
        done = subprocess.run([TOOL, "--build", BUILD, "--folder", "drivers", "--only", FILE, "--json", found, *options],
                              capture_output=True, text=True, timeout=500, check=False)
        if not os.path.exists(found):
            return done, []
        with open(found, encoding="utf-8") as file:
            return done, json.load(file)


class ChangesTest(unittest.TestCase):
    def setUp(self):
        self.mutants = load()

    def changed(self, line):
        return {changed.strip() for _, changed in self.mutants.changes_of(line)}

    def test_each_operator_by_those_that_it_is_confused_with(self):
        self.assertEqual(self.changed("  if (a < b) {"), {"if (a >= b) {", "if (a <= b) {"})
        self.assertEqual(self.changed("  return a - b * c;"), {"return a + b * c;", "return a - b / c;"})
        self.assertEqual(self.changed("  return a && b;"), {"return a || b;"})
        self.assertEqual(self.changed("  return std::min(a, 3);"), {"return std::max(a, 3);"})
        self.assertEqual(self.changed("  is_done_ = true;"), {"is_done_ = false;", ""})
        self.assertEqual(self.changed("  reset();"), {""})

    def test_no_text_comment_template_parameter_or_declaration(self):
        for line in ('  // a < b', '  say("a < b, a - b and true");', '#include "a.hpp"', "  std::vector<int> a;", "  const int a = b();",
                     '    visit.value("a", self.a, Range{0.0, 1.0},', "  int f(T&& a) {"):
            self.assertLessEqual(self.changed(line), {""}, line)
        self.assertEqual(self.changed("  return std::span<const int>(a).first(n);"), set())


class TrialTest(unittest.TestCase):
    def test_errors_in_a_parser_are_caught_and_nothing_is_written(self):
        files = [os.path.join(PROJECT, FILE), os.path.join(BUILD, "bin/test_drivers"), os.path.join(BUILD, "drivers/libodoless_drivers.a")]
        before = [contents(path) for path in files]
        done, errors = trial("--count", "3")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual([error["file"] for error in errors], 3 * [FILE])
        for error in errors:
            self.assertRegex(error["caught"], r"^\w+.*\.\w+|too slow|status")
        self.assertEqual(before, [contents(path) for path in files])

    def test_what_is_interrupted_tells_what_it_has_found(self):
        with tempfile.TemporaryDirectory() as folder:
            found = os.path.join(folder, "errors.json")
            with subprocess.Popen([TOOL, "--build", BUILD, "--folder", "drivers", "--only", FILE, "--json", found, "--count", "50"],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as trial_of_many:
                first = trial_of_many.stdout.readline()
                self.assertIn("1/50", first)
                self.assertIn("/50", trial_of_many.stdout.readline(), "the first is written by now")
                trial_of_many.terminate()
                rest = trial_of_many.stdout.read()
            with open(found, encoding="utf-8") as file:
                self.assertIn(json.load(file)[0]["error"], first)
            self.assertIn("stopped before its end", rest)
            self.assertRegex(rest, r"\d+ of [1-5] errors caught")

    def test_a_folder_without_such_a_file_is_refused(self):
        done, errors = trial("--only", "drivers/nothing.cpp")
        self.assertEqual((done.returncode, errors), (66, []))
        self.assertIn("no line of a .cpp file in drivers fits 'drivers/nothing.cpp'", done.stderr)

    def test_a_tree_that_is_not_built_is_refused(self):
        done = subprocess.run([TOOL, "--build", "/nonexistent"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 66)
        self.assertIn("tools/build release", done.stderr)


if __name__ == "__main__":
    unittest.main()
