"""Which ctest test runs a test that the matrix names, and with which command it is run alone."""

import fnmatch
import json
import os
import re
import subprocess


class Registry:
    def __init__(self, build, sources):
        listed = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], capture_output=True, text=True, check=True)
        self._sources = sources
        self._tests = {}
        for test in json.loads(listed.stdout)["tests"]:
            folder = next((each["value"] for each in test.get("properties", []) if each["name"] == "WORKING_DIRECTORY"), build)
            self._tests[test["name"]] = (test.get("command", []), folder)

    def names(self):
        return set(self._tests)

    def commands(self, name):
        """Pairs of a command and the folder to run it in; none where there is no such test."""
        if ":" not in name:
            return [self._tests[each] for each in sorted(self._tests) if fnmatch.fnmatchcase(each, name)]
        path, method = name.split(":")
        if not self._has_method(path, method):
            return []
        if path.startswith("tests/hil/"):
            return [(command + [method.removeprefix("test_")], folder) for command, folder in [self._tests.get("hil.standard", ([], ""))] if command]
        return [(command + ["-k", method], folder) for command, folder in self._tests.values()
                if os.path.join(self._sources, path) in command]

    def _has_method(self, path, method):
        file = os.path.join(self._sources, path)
        if not os.path.exists(file):
            return False
        with open(file, encoding="utf-8") as text:
            return re.search(rf"^    def {method}\(", text.read(), re.MULTILINE) is not None
