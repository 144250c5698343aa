"""What is wired to the robot's GPIO lines: emergency stop, sync pulse, the laser's power, status light."""

import glob
import os
import struct
import time

from support import PROGRAMS, DaemonTest, SimulatedGpio
from lcm_log import messages  # found by support

TURN_S = 0.1  # of the emulated URG-04LX
PULSE_DELAY_S = 0.012


def gpio_config(**keys):
    return "[gpio]\n" + "".join(f"{key} = {value!r}\n" for key, value in keys.items()).replace("'", '"')


class GpioTest(DaemonTest):
    def setUp(self):
        super().setUp()
        self.gpio = SimulatedGpio("robot", ["odo-stop", "odo-sync", "odo-power", "odo-led"])
        self.addCleanup(self.gpio.remove)

    def start_with_laser(self, environment=None, **gpio):
        laser = self.start_laser("--pty", self.path("laser"), "--truth", self.path("truth.tum"))
        self.start_daemon(f'device = "{self.path("laser")}"',
                          gpio_config(**gpio) + f'[recorder]\npath = "{self.path("run")}"\n', **environment or {})
        self.wait_for_scans(5, 30)
        return laser

    def is_stopped(self):
        return "emergency stop" in self.status()

    def is_released(self):
        self.gpio.set_level("odo-stop", True)  # again: opened anew, it is pulled down
        return not self.is_stopped()

    def test_the_emergency_stop_is_fail_safe(self):
        self.gpio.set_level("odo-stop", False)
        self.start_with_laser({"LD_PRELOAD": os.path.join(PROGRAMS, "liblost_gpio.so"),
                               "ODOLESS_LOST_GPIO": self.path("lost")}, stop_line="odo-stop")
        self.assertTrue(self.is_stopped(), "low is a stop, and the line is pulled there when nothing drives it")
        self.gpio.set_level("odo-stop", True)
        self.wait_until(lambda: not self.is_stopped(), 1, "the release")
        self.gpio.set_level("odo-stop", False)
        self.assertLess(self.wait_until(self.is_stopped, 1, "the stop"), 0.5)
        self.gpio.set_level("odo-stop", True)
        self.wait_until(lambda: not self.is_stopped(), 1, "the release")
        with open(self.path("lost"), "w", encoding="ascii"):
            self.assertLess(self.wait_until(self.is_stopped, 1, "the stop by a lost line"), 0.5)
            self.wait_until(lambda: "GPIO line" in self.status(), 1, "the flag")
        os.remove(self.path("lost"))
        self.wait_until(self.is_released, 3, "the line's return")

    def test_the_sync_pulses_stamps_drive_the_scan_clock(self):
        self.start_with_laser(sync_line="odo-sync")
        first_beam_s = self.last_true_stamp_s()
        pulses = dict(self.give_pulse(first_beam_s) for _ in range(30))
        time.sleep(1)
        checked = 0
        for stamp_s in self.scan_stamps_s():
            turn = round((stamp_s - first_beam_s - PULSE_DELAY_S / 2) / TURN_S)
            if turn in sorted(pulses)[5:]:  # some pulses must have come before a turn's time is known
                before_s, after_s = pulses[turn]
                self.assertTrue(before_s - 1e-4 <= stamp_s <= after_s + 1e-3, (stamp_s, before_s, after_s))
                checked += 1
        self.assertGreater(checked, 20)
        self.wait_until(lambda: "sync pulse is missing" in self.status(), 5, "the flag of missing pulses")

    def give_pulse(self, first_beam_s):
        """One pulse, later than the first beam, so that stamps that follow it aren't those of the laser's own clock.

        Returns by which turn since then, and when: surely after the first moment and before the second.
        """
        turn = int((time.time() - first_beam_s - PULSE_DELAY_S) // TURN_S) + 1
        time.sleep(max(0.0, first_beam_s + turn * TURN_S + PULSE_DELAY_S - time.time()))
        before_s = time.time()
        self.gpio.set_level("odo-sync", True)
        after_s = time.time()
        self.gpio.set_level("odo-sync", False)
        return turn, (before_s, after_s)

    def last_true_stamp_s(self):
        with open(self.path("truth.tum"), encoding="ascii") as truth:
            return float(truth.readlines()[-1].split()[0])

    def recorded(self, wanted):
        """(stamp in s, data behind it) of that channel's messages."""
        (log,) = glob.glob(self.path("run.*.lcm"))
        return [(struct.unpack(">q", data[8:16])[0] * 1e-6, data[16:]) for channel, data in messages(log)
                if channel == wanted]

    def scan_stamps_s(self):
        return [stamp_s for stamp_s, _ in self.recorded("ODOLESS_SCAN")]

    def last_power_off_s(self):
        def has_both():
            switched = [(stamp_s, data[4:]) for stamp_s, data in self.recorded("ODOLESS_GPIO_RAW_TX")
                        if data[4:].startswith(b"power")]
            return [text for _, text in switched[-2:]] == [b"power low\n", b"power high\n"] and switched

        self.wait_until(has_both, 10, "its record")
        (off_s, _), (on_s, _) = has_both()[-2:]
        return on_s - off_s

    def test_a_dead_laser_is_switched_off_and_on(self):
        laser = self.start_with_laser(power_line="odo-power", power_cycle_after_ms=1500.0, power_off_ms=500.0)
        self.assertEqual(self.gpio.value("odo-power"), 1)
        laser.kill()
        self.assertGreater(self.wait_until(lambda: self.gpio.value("odo-power") == 0, 5, "power off"), 1.0)
        self.wait_until(lambda: self.gpio.value("odo-power") == 1, 5, "power on")
        off_s = self.last_power_off_s()  # as the daemon's own stamps have it
        self.assertGreaterEqual(off_s, 0.5)
        self.assertLess(off_s, 0.7)
        self.start_laser("--pty", self.path("laser"))
        self.wait_for_scans(3, 10)
        time.sleep(2)
        self.assertEqual(self.gpio.value("odo-power"), 1, "and stays on while it scans")

    def test_the_status_light_shows_the_state(self):
        laser = self.start_with_laser(led_line="odo-led")
        light = self.light_for(4)  # without a filter, the state is INIT: a second on, a second off
        self.assertAlmostEqual(self.share_on(light), 0.5, delta=0.1)
        self.assertIn(self.changes(light), (3, 4, 5))
        laser.kill()
        self.wait_until(lambda: "FAULT" in self.status(), 5, "the fault")
        self.assertGreater(self.changes(self.light_for(2)), 15)

    def light_for(self, seconds):
        """Moments, and whether it shone."""
        end = time.monotonic() + seconds
        samples = []
        while time.monotonic() < end:
            samples.append((time.monotonic(), self.gpio.value("odo-led")))
            time.sleep(0.01)
        return samples

    @staticmethod
    def share_on(samples):
        on = sum(after[0] - before[0] for before, after in zip(samples, samples[1:]) if before[1])
        return on / (samples[-1][0] - samples[0][0])

    @staticmethod
    def changes(samples):
        return sum(before[1] != after[1] for before, after in zip(samples, samples[1:]))
