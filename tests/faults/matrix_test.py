"""That the matrix is whole: each row has tests, which ctest runs, and a line in the README with all that is promised.

    matrix_test.py BUILD ROOT_OF_SOURCES
"""

import os
import sys
import unittest

BUILD, SOURCES = sys.argv[1:3]
FAULTS = os.path.join(SOURCES, "tests", "faults")
sys.path.insert(0, FAULTS)
from matrix import ROWS
from registry import Registry
from table import KEPT, described, read, verdict


class Matrix(unittest.TestCase):
    def test_has_the_rows_1_to_42(self):
        self.assertEqual([row.number for row in ROWS], list(range(1, 43)))

    def test_names_tests_that_ctest_runs(self):
        registry = Registry(BUILD, SOURCES)
        for row in ROWS:
            self.assertTrue(row.tests, row.fault)
            for name in row.tests:
                self.assertTrue(registry.commands(name), f"row {row.number}: ctest runs no {name}")

    def test_each_test_of_the_matrix_is_named_by_its_row(self):
        named = {name for row in ROWS for name in row.tests}
        own = {name for name in Registry(BUILD, SOURCES).names() if name.startswith("FaultMatrix.")}
        self.assertEqual(own - named, set())

    def test_the_readme_has_each_row_as_it_is(self):
        lines = read(os.path.join(FAULTS, "README.md"))
        self.assertEqual(len(lines), len(ROWS))
        for row, cells in zip(ROWS, lines):
            self.assertEqual(len(cells), 6, cells)
            self.assertEqual(cells[:4], described(row), "run tools/fault-matrix")
            self.assertRegex(cells[5], KEPT)
            for what in row.bounds:
                self.assertTrue(what in cells[4] or cells[5].startswith("not run"), f"row {row.number}: {what} is not measured")

    def test_a_promise_that_is_not_kept_is_said(self):
        row = next(row for row in ROWS if row.number == 1)
        passed = {"tests": {name: {"outcome": "passed"} for name in row.tests}}
        kept = {what: {"value": bound, "unit": "s"} for what, bound in row.bounds.items()}
        self.assertEqual(verdict(row, passed | {"measured": kept}), "yes")
        late = kept | {"recover": {"value": 3.14, "unit": "s"}}
        self.assertEqual(verdict(row, passed | {"measured": late}), "**no**: recover 3.14 s instead of 2")
        never = kept | {"recover": {"value": float("inf"), "unit": "s"}}
        self.assertIn("**no**: recover not in the run", verdict(row, passed | {"measured": never}))
        self.assertIn("not measured", verdict(row, passed | {"measured": {}}))
        skipped = {"tests": {name: {"outcome": "skipped"} for name in row.tests}, "measured": kept}
        self.assertIn("not run", verdict(row, skipped))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
