"""A laser on USB: through the kernel's driver, and without it; pulled out and plugged in again."""

import glob
import os
import re
import termios
import tty

from support import DaemonTest, program, run

TTY = "/dev/ttyACM0"
USB_ADDRESS = "usb://15d1:0000/H0000001"


def is_plugged_in(number="H0000001"):
    for path in glob.glob("/sys/bus/usb/devices/*/serial"):
        try:
            with open(path, encoding="ascii") as serial:
                if serial.read().strip() == number:
                    return True
        except OSError:
            pass  # it is pulled out at this very moment
    return False


class UsbTest(DaemonTest):
    def plug_in(self, number="H0000001"):
        laser = self.start_laser("--usbip", "--usb-serial", number)
        self.wait_until(lambda: is_plugged_in(number), 10, "plugging in")
        return laser

    def pull_out(self, laser, number="H0000001"):
        laser.kill()
        laser.wait()
        self.wait_until(lambda: not is_plugged_in(number), 10, "pulling out")

    def test_an_emulated_laser_is_a_serial_line_of_the_kernel(self):
        laser = self.plug_in()
        self.wait_until(lambda: os.path.exists(TTY), 10, TTY)
        line = os.open(TTY, os.O_RDWR | os.O_NOCTTY)
        self.addCleanup(os.close, line)
        tty.setraw(line)
        termios.tcflush(line, termios.TCIOFLUSH)
        for request, answer in ((b"SCIP2.0\n", b"SCIP2.0\n0"), (b"VV\n", b"VV\n00P\nVEND:Hokuyo")):
            os.write(line, request)
            heard = b""
            while not heard.endswith(b"\n\n"):
                heard += os.read(line, 4096)
            self.assertTrue(heard.startswith(answer), heard)
        self.pull_out(laser)
        self.wait_until(lambda: not os.path.exists(TTY), 5, "the end of the line")

    def scans_survive_unplugging(self, device, is_there):
        laser = self.plug_in()
        self.wait_until(is_there, 10, "the device")
        self.start_daemon(f'device = "{device}"')
        self.wait_for_scans(20, 30)
        self.pull_out(laser)
        self.wait_until(lambda: "no scans" in self.status(), 1, "the flag")
        self.plug_in()
        self.wait_until(is_there, 10, "the device's return")
        self.assertLess(self.wait_for_scans(1, 10), 1.0)
        self.wait_for_scans(20, 20)

    def test_the_daemon_reads_a_laser_through_the_kernels_driver_and_survives_unplugging(self):
        self.scans_survive_unplugging(TTY, lambda: os.path.exists(TTY))

    def test_the_daemon_reads_a_laser_without_the_kernels_driver_and_survives_unplugging(self):
        self.scans_survive_unplugging(USB_ADDRESS, is_plugged_in)

    def test_a_laser_of_two_is_known_by_its_serial_number_when_a_hub_with_both_comes_back(self):
        lasers = {number: self.plug_in(number) for number in ("H0000001", "H0000002")}
        self.start_daemon(f'device = "{USB_ADDRESS.replace("H0000001", "H0000002")}"')
        self.wait_for_scans(5, 30)
        for number, laser in lasers.items():
            self.pull_out(laser, number)
        self.wait_until(lambda: "no scans" in self.status(), 5, "the flag")
        lasers = {number: self.plug_in(number) for number in reversed(lasers)}  # each gets the other's names
        self.wait_for_scans(5, 20)
        self.pull_out(lasers["H0000001"])
        self.wait_for_scans(5, 5)
        self.pull_out(lasers["H0000002"], "H0000002")
        self.wait_until(lambda: "no scans" in self.status(), 5, "the flag")

    def test_scans_are_the_same_through_the_kernels_driver_and_without_it(self):
        self.LASER = tuple(word for word in self.LASER if word != "--start-at-once")  # scan 0 is the first that is asked for
        heard = []
        for name, device in (("kernel", TTY), ("without", USB_ADDRESS)):
            laser = self.plug_in()
            self.wait_until(lambda: os.path.exists(TTY), 10, TTY)
            daemon = self.start_daemon(f'device = "{device}"', f'[recorder]\npath = "{self.path(name)}"\n')
            self.wait_for_scans(12, 30)
            daemon.terminate()
            self.assertEqual(self.end_of(daemon), 0)
            self.pull_out(laser)
            heard.append(self.ranges(*glob.glob(self.path(f"{name}.*.lcm"))))
        self.assertGreater(len(self.common_scans(*heard)), 8)

    def test_a_laser_is_given_back_to_the_kernel(self):
        self.plug_in()
        self.wait_until(lambda: os.path.exists(TTY), 10, TTY)
        daemon = self.start_daemon(f'device = "{USB_ADDRESS}"')
        self.wait_for_scans(5, 30)
        self.assertFalse(os.path.exists(TTY))
        daemon.terminate()
        self.assertEqual(self.end_of(daemon), 0)
        self.wait_until(lambda: os.path.exists(TTY), 5, TTY)

    def test_probe_finds_the_laser_and_prints_a_configuration_that_works(self):
        self.plug_in()
        self.wait_until(lambda: os.path.exists(TTY), 10, TTY)
        outcome = run(*program("odoless", "probe"))
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertIn("682 beams", outcome.stdout)
        self.assertIn(USB_ADDRESS, outcome.stdout)
        self.assertIn("# CAN interface vcan0", outcome.stdout)
        self.start_daemon(re.search(r'(?m)^device = .*$', outcome.stdout)[0])
        self.wait_for_scans(5, 30)
