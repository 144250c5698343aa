"""What is installed to run a robot: udev's names and owners of devices, and the kernel's settings."""

import grp
import os
import shutil
import stat
import subprocess

from support import SOURCES, DaemonTest, SimulatedGpio, run

UDEVD = "/lib/systemd/systemd-udevd"


class OperationTest(DaemonTest):
    def setUp(self):
        super().setUp()
        if not os.path.exists(UDEVD):
            self.skipTest("udev is not installed")
        with open("/etc/group", "a", encoding="ascii") as group:
            group.write("odoless:x:7777:\n")
        os.makedirs("/run/udev/rules.d", exist_ok=True)
        shutil.copy(os.path.join(SOURCES, "config/udev/60-odoless.rules"), "/run/udev/rules.d/")
        self.udevd = self.start(UDEVD, stderr=subprocess.PIPE)
        self.wait_until(lambda: os.path.exists("/run/udev/control"), 10, "udev")

    def assert_for_the_group(self, path):
        status = os.stat(path)
        self.assertEqual(stat.S_IMODE(status.st_mode), 0o660, path)
        self.assertEqual(grp.getgrgid(status.st_gid).gr_name, "odoless", path)

    def test_the_kernel_takes_its_settings(self):
        with open(os.path.join(SOURCES, "config/sysctl/60-odoless.conf"), encoding="ascii") as settings:
            for line in settings:
                if line.strip() and not line.startswith("#"):
                    key, value = (part.strip() for part in line.split("="))
                    path = "/proc/sys/" + key.replace(".", "/")
                    with open(path, "w", encoding="ascii") as setting:
                        setting.write(value)
                    with open(path, encoding="ascii") as setting:
                        self.assertEqual(setting.read().strip(), value)

    def test_a_laser_and_gpio_get_their_names_and_owners(self):
        gpio = SimulatedGpio("udev", ["a"])
        self.addCleanup(gpio.remove)
        self.start_laser("--usbip")
        self.wait_until(lambda: os.path.exists("/dev/odoless/lrf-H0000001") and os.path.exists("/dev/odoless/lrf"), 20,
                        "the laser's names")
        self.assertEqual(os.path.realpath("/dev/odoless/lrf"), "/dev/ttyACM0")
        self.start_laser("--usbip", "--usb-serial", "H0000002")
        self.wait_until(lambda: os.path.exists("/dev/odoless/lrf-H0000002"), 20, "the name of another of the model")
        self.assertEqual(os.path.realpath("/dev/odoless/lrf-H0000001"), "/dev/ttyACM0")
        self.assertEqual(os.path.realpath("/dev/odoless/lrf-H0000002"), "/dev/ttyACM1")
        self.assert_for_the_group("/dev/odoless/lrf")
        run("udevadm", "settle", "--timeout=10")
        properties = run("udevadm", "info", "--query=property", "--name=/dev/ttyACM0").stdout
        self.assertIn("ID_MM_DEVICE_IGNORE=1", properties)
        self.assert_for_the_group(f"/dev/{gpio.chip}")
        device = run("udevadm", "info", "--query=path", "--name=/dev/ttyACM0").stdout.strip()
        usb = os.path.realpath(f"/sys{device}/../../..")
        with open(os.path.join(usb, "uevent"), encoding="ascii") as file:
            name = next(line.split("=")[1].strip() for line in file if line.startswith("DEVNAME="))
        self.assert_for_the_group(f"/dev/{name}")
        self.udevd.terminate()
        complaints = [line for line in self.udevd.communicate(timeout=10)[1].splitlines() if "60-odoless" in line]
        self.assertEqual(complaints, [])
