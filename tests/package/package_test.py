#!/usr/bin/env python3
"""The Debian packages of tools/package: that they are the same twice, that lintian finds no error, and that they can be
installed, used, upgraded and purged without a trace.

    package_test.py FOLDER_OF_THE_BUILD [--root FOLDER]
    package_test.py --packages FOLDER --root FOLDER     of packages that are made

Without --root, in an overlay over this machine, whose packages are those that ours depend on. With a clean root, as
`debootstrap --variant=minbase bookworm FOLDER` makes it, what they depend on is installed from Debian's mirror.
"""

import glob
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import root

PROJECT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
SKIPPED = 77
PACKAGES = ["libodoless-dev", "odoless", "odoless-lcm-types", "odoless-tools"]
PATIENCE_S = 60
PROGRAM = r"""
#include <cstdio>
#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"
int main() { std::printf("%d\n", odoless::Pose2{1.0, 2.0, 0.0}.x_m == 1.0); }
"""


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=200, check=False, **options)


def made(build, out):
    outcome = run(os.path.join(PROJECT, "tools/package"), "--from", build, "--out", out)
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    return sorted(glob.glob(os.path.join(out, "*.deb")))


def digest(path):
    with open(path, "rb") as file:
        return os.path.basename(path), hashlib.sha256(file.read()).hexdigest()


def with_version(package, version, folder):
    """The same package of another version."""
    tree = os.path.join(folder, "tree")
    shutil.rmtree(tree, ignore_errors=True)
    subprocess.run(["dpkg-deb", "-R", package, tree], check=True)
    control = os.path.join(tree, "DEBIAN/control")
    with open(control, encoding="utf-8") as file:
        text = re.sub(r"(?m)^Version: .*$", "Version: " + version, file.read())
    with open(control, "w", encoding="utf-8") as file:
        file.write(text)
    other = os.path.join(folder, f"{os.path.basename(package).split('_')[0]}_{version}.deb")
    subprocess.run(["dpkg-deb", "-Znone", "-b", tree, other], check=True, stdout=subprocess.DEVNULL)
    return other


class PackageTest(unittest.TestCase):
    build = ""
    folder = ""
    packages = []

    def test_the_same_build_gives_the_same_bytes(self):
        if not self.build:
            self.skipTest("no build is given, only its packages")
        again = made(self.build, os.path.join(self.folder, "again"))
        self.assertEqual([digest(path) for path in self.packages], [digest(path) for path in again])
        self.assertEqual(sorted(os.path.basename(path).split("_")[0] for path in self.packages), PACKAGES)

    @unittest.skipUnless(shutil.which("lintian"), "lintian is not installed (tools/setup installs it)")
    def test_lintian_finds_no_error(self):
        outcome = run("lintian", "--allow-root", "--fail-on", "error", "--no-tag-display-limit", *self.packages)
        self.assertEqual(outcome.returncode, 0, outcome.stdout + outcome.stderr)


class InstallTest(unittest.TestCase):
    """One life of the packages, step by step."""

    lower = problem = ""
    packages = []

    def setUp(self):
        if self.problem:
            self.skipTest(self.problem)
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        self.root = root.Root(self.lower)
        if self.root.problem:
            self.skipTest("no overlay can be mounted here: " + self.root.problem)
        self.newer = [with_version(path, "9.9.9", folder) for path in self.packages]

    def succeed(self, *command, **options):
        outcome = self.root.run(*command, **options)
        self.assertEqual(outcome.returncode, 0, f"{command}: {outcome.stdout}{outcome.stderr}")
        return outcome.stdout

    def install(self, packages):
        inside = [shutil.copy(path, self.root.at("tmp")).removeprefix(self.root.path) for path in packages]
        if self.lower == "/":
            self.succeed("dpkg", "--force-unsafe-io", "--no-triggers", "--install", *inside)
        else:
            self.succeed("apt-get", "-qq", "--yes", "--no-install-recommends", "install", *inside, timeout=600)

    def start(self, *command):
        with open(self.root.at("tmp/said"), "a", encoding="utf-8") as said:
            process = subprocess.Popen(self.root.command(*command, user="odoless"), stdout=said, stderr=said)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def map_as_service_user(self):
        """The command of the unit, on an emulated laser, until it has mapped a little."""
        os.makedirs(self.root.at("run/odoless"), exist_ok=True)
        self.succeed("chown", "odoless:odoless", "/run/odoless")  # as RuntimeDirectory= does
        with open(self.root.at("etc/odoless/robot.toml"), "w", encoding="utf-8") as file:
            file.write('[lrf]\ndevice = "/run/odoless/laser"\n[lcm]\nurl = ""\n')
        laser = self.start("odoless", "emulate", "lrf", "--from", "/usr/share/odoless/worlds/rooms.world", "--pty",
                           "/run/odoless/laser")
        self.wait_for(lambda: os.path.lexists(self.root.at("run/odoless/laser")))
        unit = self.root.text("usr/lib/systemd/system/odolessd.service")
        daemon = self.start(*re.search(r"(?m)^ExecStart=(.*)$", unit)[1].split())
        self.wait_for(self.has_mapped, daemon)
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=PATIENCE_S), 0, self.root.text("tmp/said"))
        laser.terminate()  # a user whose programs run cannot be removed
        laser.wait()

    def has_mapped(self):
        status = self.root.run("odoless", "ctl", "status", "--json")
        if status.returncode != 0:
            return False
        said = json.loads(status.stdout)
        return said["pose"] is not None and said["scans"]["accepted"] >= 20

    def wait_for(self, condition, process=None):
        end = time.monotonic() + PATIENCE_S
        while not condition():
            ended = process is not None and process.poll() is not None
            if ended or time.monotonic() > end:
                self.fail(("the daemon has ended: " if ended else "waited in vain: ") + self.root.text("tmp/said"))
            time.sleep(0.2)

    def check_what_is_installed(self):
        self.assertRegex(self.succeed("odolessd", "--version"), r"^odolessd \d")
        self.assertIn("odoless", self.succeed("id", "odoless"))
        self.assertIn("dialout", self.succeed("id", "odoless"))
        self.succeed("bash", "-n", "/usr/share/bash-completion/completions/odoless")
        for page in ("man1/odoless.1.gz", "man8/odolessd.8.gz"):
            self.assertTrue(os.path.isfile(self.root.at("usr/share/man/" + page)))

    def check_library(self):
        if not os.path.exists(self.root.at("usr/bin/g++")):
            return
        with open(self.root.at("tmp/program.cpp"), "w", encoding="utf-8") as file:
            file.write(PROGRAM)
        flags = self.succeed("pkg-config", "--cflags", "--libs", "odoless").split()
        self.succeed("g++", "/tmp/program.cpp", *flags, "-o", "/tmp/program")
        self.assertEqual(self.succeed("/tmp/program"), "1\n")

    def test_install_use_upgrade_purge(self):
        self.install(self.packages)
        self.check_what_is_installed()
        self.check_library()
        self.map_as_service_user()
        with open(self.root.at("var/lib/odoless/latest/map.pgm"), "rb") as file:
            saved = file.read()
        edited = self.root.text("etc/odoless/robot.toml")
        self.install(self.newer)
        self.assertEqual(self.succeed("dpkg-query", "-Wf", "${Version}", "odoless"), "9.9.9")
        self.assertEqual(self.root.text("etc/odoless/robot.toml"), edited)
        with open(self.root.at("var/lib/odoless/latest/map.pgm"), "rb") as file:
            self.assertEqual(file.read(), saved)
        self.succeed("dpkg", "--force-unsafe-io", "--no-triggers", "--purge", *PACKAGES)
        if self.lower == "/":
            self.assertEqual(self.root.changed(), [])
        else:
            left = self.root.run("find", "/etc", "/usr", "/var/lib/odoless", "/run", "-name", "*odoless*").stdout
            self.assertEqual(left, "")
            self.assertNotIn("odoless", self.root.text("etc/passwd") + self.root.text("etc/group"))


def option(name):
    return os.path.realpath(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else None


def main():
    InstallTest.lower = option("--root") or "/"
    packages = option("--packages")
    if not packages and not shutil.which("dpkg-shlibdeps"):
        print("dpkg-shlibdeps is not installed (tools/setup installs dpkg-dev): skipped")
        return SKIPPED
    InstallTest.problem = root.enter_namespace([sys.executable, "-B", *sys.argv])
    with tempfile.TemporaryDirectory() as folder:
        PackageTest.folder = folder
        if packages:
            PackageTest.packages = [path for name in PACKAGES for path in glob.glob(os.path.join(packages, name + "_*.deb"))]
        else:
            PackageTest.build = os.path.realpath(sys.argv[1])
            PackageTest.packages = made(PackageTest.build, os.path.join(folder, "once"))
        InstallTest.packages = PackageTest.packages
        outcome = unittest.main(argv=sys.argv[:1], verbosity=2, exit=False).result
    return 0 if outcome.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
