"""The installed libraries: a project of its own finds each component, includes "core/...", "rt/..." and "drivers/...", and links.

    installed_test.py FOLDER_OF_THE_BUILD FOLDER
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import drive

EXAMPLES = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../tools/examples")
CMAKE = """cmake_minimum_required(VERSION 3.25)
project(consumer CXX)
find_package(odoless 0.1 REQUIRED COMPONENTS {component})
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE odoless::{component})
"""
MAINS = {
    "c": '#include <odoless.h>\nint main() { return odoless_create("?", 1, nullptr) == ODOLESS_BAD_ARGUMENT ? 0 : 1; }\n',
    "rt": '#include "rt/clock.hpp"\nint main() { return odoless::MonotonicClock().now_ns() > 0 ? 0 : 1; }\n',
    "drivers": '#include "drivers/lrf/make_lrf_session.hpp"\n'
               "int main() { return odoless::make_lrf_session({}, 1081)->ready() ? 1 : 0; }\n",
}


class InstalledTest(unittest.TestCase):
    build = ""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.prefix = os.path.join(cls.folder, "prefix")
        cls.succeed("cmake", "--install", cls.build, "--component", "dev", "--prefix", cls.prefix)

    @classmethod
    def run_in(cls, *command, **options):
        return subprocess.run(command, capture_output=True, text=True, check=False, **options)

    @classmethod
    def succeed(cls, *command, **options):
        outcome = cls.run_in(*command, **options)
        assert outcome.returncode == 0, f"{command}: {outcome.stdout}{outcome.stderr}"
        return outcome.stdout

    def configure(self, source, *options):
        return self.run_in("cmake", "-G", "Ninja", "-S", source, "-B", source + "/build", f"-DCMAKE_PREFIX_PATH={self.prefix}", *options)

    def consumer(self, component, main):
        source = os.path.join(self.folder, component)
        os.makedirs(source)
        for name, text in (("CMakeLists.txt", CMAKE.format(component=component)), ("main.cpp", main)):
            with open(os.path.join(source, name), "w", encoding="utf-8") as file:
                file.write(text)
        return source

    def test_each_component_is_found_and_linked(self):
        for component, main in MAINS.items():
            with self.subTest(component):
                source = self.consumer(component, main)
                outcome = self.configure(source)
                self.assertEqual(outcome.returncode, 0, outcome.stderr)
                self.succeed("cmake", "--build", source + "/build")
                self.succeed(source + "/build/consumer")

    def test_a_component_that_is_none_is_refused_by_name(self):
        outcome = self.configure(self.consumer("firmware", ""))
        self.assertNotEqual(outcome.returncode, 0)
        self.assertIn("odoless has no component firmware; it has core, rt, drivers", outcome.stderr)

    def test_without_build_testing_there_are_no_tests(self):
        build = os.path.join(self.folder, "no_tests")
        self.succeed("cmake", "-G", "Ninja", "-S", os.path.join(EXAMPLES, "../.."), "-B", build, "-DODOLESS_DEVELOP=ON", "-DBUILD_TESTING=OFF")
        made = self.succeed("cmake", "--build", build, "--target", "help")
        self.assertIn("odolessd", made)
        self.assertNotIn("test_core", made)

    def test_an_example_is_built_away_from_the_sources(self):
        source = os.path.join(self.folder, "away/tools/examples")
        shutil.copytree(EXAMPLES, source)
        outcome = self.configure(source)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.succeed("cmake", "--build", source + "/build", "--target", "match_two_scans")
        said = self.succeed(source + "/build/match_two_scans", input=drive.lines(2))
        self.assertIn("converged", said)


if __name__ == "__main__":
    sys.argv.pop()
    InstalledTest.build = sys.argv.pop()
    unittest.main()
