"""Runs every test of this folder in the guest and reports each of them as ctest does.

    suite.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES [NAME...]

A test is a method of a TestCase in *_test.py, or a test of a GoogleTest program bin/test_hil*. With names, only tests
whose full name contains one of them.
"""

import glob
import json
import os
import subprocess
import sys
import time
import unittest

PROGRAMS, SOURCES = sys.argv[1:3]
NAMES = sys.argv[3:]
HERE = os.path.dirname(os.path.abspath(__file__))


def wanted(name):
    return not NAMES or any(part in name for part in NAMES)


class Report:
    """Lines as of ctest, and what failed."""

    def __init__(self):
        self.start = time.monotonic()
        self.count = 0
        self.failed = []
        self.skipped = []

    def add(self, name, outcome, seconds, text=""):
        self.count += 1
        dots = "." * max(3, 100 - len(name))
        print(f"Test {self.count:3}: {name} {dots} {outcome:>8} {seconds:7.2f} sec", flush=True)
        if text:
            print(text.rstrip(), flush=True)
        if outcome == "Failed":
            self.failed.append(name)
        if outcome == "Skipped":
            self.skipped.append(name)

    def summary(self):
        ran = self.count - len(self.skipped)
        print(f"\n{ran - len(self.failed)} of {ran} tests passed, {len(self.skipped)} skipped")
        for name in self.failed:
            print(f"  failed: {name}")
        print(f"Total test time in the guest = {time.monotonic() - self.start:.2f} sec", flush=True)
        return 1 if self.failed or self.count == 0 else 0


class Result(unittest.TestResult):
    def __init__(self, report):
        super().__init__()
        self.report = report
        self.problem = None

    def startTest(self, test):
        super().startTest(test)
        self.problem = ("Passed", "")
        self.began = time.monotonic()

    def stopTest(self, test):
        super().stopTest(test)
        self.report.add(name_of(test), self.problem[0], time.monotonic() - self.began, self.problem[1])

    def addFailure(self, test, err):
        self.problem = ("Failed", self.problem[1] + self._exc_info_to_string(err, test))

    addError = addFailure

    def addSkip(self, test, reason):
        self.problem = ("Skipped", reason)

    def addSubTest(self, test, subtest, err):
        if err is not None:
            self.addFailure(subtest, err)


def name_of(test):
    module, _, rest = test.id().partition(".")
    return f"hil.{module.removesuffix('_test')}.{rest.split('.')[-1].removeprefix('test_')}"


def tests_in(suite):
    for item in suite:
        if isinstance(item, unittest.TestSuite):
            yield from tests_in(item)
        else:
            yield item


def run_scripts(report):
    found = unittest.defaultTestLoader.discover(HERE, "*_test.py")
    result = Result(report)
    for test in tests_in(found):
        if wanted(name_of(test)) or not hasattr(test, "_testMethodName"):
            test.run(result)
    for test in unittest.defaultTestLoader.errors:
        report.add("hil.discover", "Failed", 0.0, test)


def run_program(path, report):
    outcome_file = f"/tmp/{os.path.basename(path)}.json"
    listing = subprocess.run([path, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
    names, suite = [], ""
    for line in listing.splitlines():
        if line.startswith("  "):
            names.append(suite + line.split("#")[0].strip())
        elif line.endswith("."):
            suite = line
    names = [name for name in names if wanted("hil." + name)]
    if not names:
        return
    done = subprocess.run([path, "--gtest_filter=" + ":".join(names), f"--gtest_output=json:{outcome_file}"],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if not os.path.exists(outcome_file):
        report.add("hil." + os.path.basename(path), "Failed", 0.0, f"ended with {done.returncode}\n{done.stdout}")
        return
    with open(outcome_file, encoding="utf-8") as file:
        for group in json.load(file)["testsuites"]:
            for test in group["testsuite"]:
                problems = "\n".join(failure["failure"] for failure in test.get("failures", []))
                outcome = "Failed" if problems else "Skipped" if test["result"] == "SKIPPED" else "Passed"
                report.add(f"hil.{group['name']}.{test['name']}", outcome, float(test["time"].rstrip("s")), problems)


def main():
    report = Report()
    for path in sorted(glob.glob(os.path.join(PROGRAMS, "test_hil*"))):
        run_program(path, report)
    run_scripts(report)
    return report.summary()


if __name__ == "__main__":
    sys.path.insert(0, HERE)
    sys.exit(main())
