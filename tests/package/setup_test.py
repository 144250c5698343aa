"""tools/setup --check: what it finds missing in a list of installed packages, which dpkg itself reads."""

import os
import subprocess
import sys
import tempfile
import unittest

SETUP = os.path.join(os.path.realpath(sys.argv[1]), "tools/setup")
STATUS = "Package: {}\nStatus: install ok {}\nMaintainer: none\nArchitecture: {}\nMulti-Arch: same\nVersion: 1\nDescription: none\n\n"


class SetupTest(unittest.TestCase):
    def missing(self, profile, *installed):
        """Of a profile, with these packages installed: (name, state, architecture)."""
        with tempfile.TemporaryDirectory() as folder:
            for name in ("info", "updates", "triggers"):
                os.mkdir(os.path.join(folder, name))
            with open(os.path.join(folder, "status"), "w", encoding="ascii") as file:
                file.write("".join(STATUS.format(*package) for package in installed))
            with open(os.path.join(folder, "arch"), "w", encoding="ascii") as file:
                file.write("amd64\narm64\n")
            outcome = subprocess.run([SETUP, "--check", profile], env={**os.environ, "DPKG_ADMINDIR": folder},
                                     capture_output=True, text=True, check=False)
            self.assertEqual(outcome.returncode, 1 if outcome.stdout else 0, outcome.stderr)
            return outcome.stdout.split()

    def test_a_package_of_two_architectures_is_not_missing(self):
        native = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True, check=True).stdout.strip()
        other = "arm64" if native == "amd64" else "amd64"
        nothing = self.missing("build")
        self.assertIn("liblcm-dev", nothing)
        both = self.missing("build", ("liblcm-dev", "installed", native), ("liblcm-dev", "installed", other))
        self.assertEqual(both, [name for name in nothing if name != "liblcm-dev"])
        self.assertIn("liblcm-dev", self.missing("build", ("liblcm-dev", "installed", other)))
        self.assertIn("liblcm-dev", self.missing("build", ("liblcm-dev", "config-files", native)))

    def test_a_build_needs_less_than_a_test(self):
        build, test = self.missing("build"), self.missing("test")
        self.assertLess(set(build), set(test))
        self.assertIn("libgtest-dev", test)
        self.assertNotIn("libgtest-dev", build)

    def test_a_cross_build_needs_the_libraries_of_the_other_architecture(self):
        native = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True, check=True).stdout.strip()
        self.assertIn("libfmt-dev:arm64", self.missing("arm64", ("libfmt-dev", "installed", native)))
        self.assertNotIn("libfmt-dev:arm64", self.missing("arm64", ("libfmt-dev", "installed", "arm64")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
