"""What is installed to run a robot: that systemd, udev and the kernel take it, and that it fits the program.

    operation_test.py FOLDER_OF_THE_BUILD
"""

import glob
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import unittest

BUILD = sys.argv[1]
SKIP = "is not on this machine"


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, **options)


class OperationTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        outcome = run("cmake", "--install", BUILD, "--prefix", "/usr", env={**os.environ, "DESTDIR": cls.folder})
        assert outcome.returncode == 0, outcome.stderr

    def installed(self, path):
        return os.path.join(self.folder, "usr", path)

    def text(self, path):
        with open(self.installed(path), encoding="utf-8") as file:
            return file.read()

    def runnable_unit(self):
        """The unit with programs that are there, so that systemd can check it."""
        unit = self.text("lib/systemd/system/odolessd.service")
        path = os.path.join(self.folder, "odolessd.service")
        with open(path, "w", encoding="utf-8") as file:
            file.write(re.sub(r"(?m)^ExecStart=\S+", "ExecStart=" + self.installed("bin/odolessd"), unit))
        return path

    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze " + SKIP)
    def test_systemd_takes_the_unit_without_a_word(self):
        outcome = run("systemd-analyze", "verify", "--man=no", self.runnable_unit())
        complaints = [line for line in (outcome.stdout + outcome.stderr).splitlines() if "odolessd" in line]
        self.assertEqual(complaints, [])

    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze " + SKIP)
    def test_the_unit_gives_little_away(self):
        outcome = run("systemd-analyze", "security", "--offline=true", "--threshold=18", self.runnable_unit())
        self.assertEqual(outcome.returncode, 0, outcome.stdout[-300:] + outcome.stderr)

    def test_the_unit_starts_the_program_with_arguments_that_it_knows(self):
        unit = self.text("lib/systemd/system/odolessd.service")
        _, *arguments = re.search(r"(?m)^ExecStart=(.*)$", unit)[1].split()
        arguments[arguments.index("--config") + 1] = self.installed("share/odoless/robot.toml")
        outcome = run(self.installed("bin/odolessd"), *arguments, "--check")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertIn("LimitRTPRIO=99", unit)  # or SCHED_FIFO is refused

    def test_the_program_notifies_systemd(self):
        path = os.path.join(self.folder, "notify")
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as service_manager:
            service_manager.bind(path)
            service_manager.settimeout(10)
            config = os.path.join(self.folder, "robot.toml")
            with open(config, "w", encoding="utf-8") as file:
                file.write(f'[lrf]\ndevice = "{self.folder}/none"\n[lcm]\nurl = ""\n[control]\nsocket = ""\n')
            daemon = subprocess.Popen([self.installed("bin/odolessd"), "--config", config],
                                      env={**os.environ, "NOTIFY_SOCKET": path}, stderr=subprocess.DEVNULL)
            try:
                self.assertEqual(service_manager.recv(4096), b"READY=1")
                self.assertTrue(service_manager.recv(4096).startswith(b"WATCHDOG=1\nSTATUS="))
                daemon.terminate()
                while (message := service_manager.recv(4096)) != b"STOPPING=1":
                    self.assertTrue(message.startswith(b"WATCHDOG=1"), message)
                self.assertEqual(daemon.wait(timeout=10), 0)
            finally:
                daemon.kill()
                daemon.wait()

    @unittest.skipUnless(run("udevadm", "verify", "--version").returncode == 0 if shutil.which("udevadm") else False,
                         "udevadm verify (of systemd 254) " + SKIP)
    def test_udev_takes_the_rules(self):
        outcome = run("udevadm", "verify", self.installed("lib/udev/rules.d/60-odoless.rules"))
        self.assertEqual(outcome.returncode, 0, outcome.stdout + outcome.stderr)

    @unittest.skipUnless(shutil.which("systemd-sysusers"), "systemd-sysusers " + SKIP)
    def test_the_user_can_be_made(self):
        root = os.path.join(self.folder, "root")
        os.makedirs(os.path.join(root, "etc"))
        with open(os.path.join(root, "etc/group"), "w", encoding="ascii") as group:
            group.write("dialout:x:20:\n")
        with open(os.path.join(root, "etc/passwd"), "w", encoding="ascii"):
            pass
        outcome = run("systemd-sysusers", f"--root={root}", self.installed("lib/sysusers.d/odoless.conf"))
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        with open(os.path.join(root, "etc/group"), encoding="ascii") as group:
            self.assertIn("dialout:x:20:odoless", group.read())

    def test_the_settings_of_the_kernel_fit_each_other(self):
        lines = self.text("lib/sysctl.d/60-odoless.conf").splitlines()
        settings = dict(re.split(r"\s*=\s*", line) for line in lines if line and not line.startswith("#"))
        self.assertEqual(set(settings), {"net.core.rmem_max", "net.core.rmem_default"})
        self.assertLessEqual(int(settings["net.core.rmem_default"]), int(settings["net.core.rmem_max"]))

    def test_nothing_else_is_installed(self):
        files = [path for path in glob.glob(self.installed("**"), recursive=True) if os.path.isfile(path)]
        many = re.compile("include/odoless/(core|rt|drivers)/|include/odoless/odoless.h$|lib/.*(cmake/odoless/|odoless(-c)?.pc$|libodoless_(core|rt|drivers|c).a$)"
                          r"|share/doc/odoless-lcm-types/examples/odoless_ros2/|share/odoless/(lcm/\w+\.lcm|worlds/\w+\.world|robot[\w-]*\.toml)$")
        paths = [os.path.relpath(path, self.installed("")) for path in files]
        self.assertEqual(sorted(path for path in paths if not many.match(path)),
                         ["bin/odoless", "bin/odolessd", "lib/sysctl.d/60-odoless.conf",
                          "lib/systemd/system/odolessd.service", "lib/sysusers.d/odoless.conf",
                          "lib/udev/rules.d/60-odoless.rules", "share/bash-completion/completions/odoless",
                          "share/man/man1/odoless.1.gz", "share/man/man8/odolessd.8.gz",
                          "share/zsh/vendor-completions/_odoless"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
