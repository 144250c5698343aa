"""The daemon with each laser's robot file of config/, on the emulated laser: it maps a building as it is driven through.

    lasers_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES [LasersTest.TEST ...]

Each drives for 25 s; with ODOLESS_DRIVE_S=70 in the environment, through all of the building (7 minutes).
"""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time

from support import SOURCES, WORLD, DaemonCase, main, run
from host_watch import HostWatch  # found by support

# Between shelves of different depths: for a laser that sees 3 m, in 70 deg.
AISLE = """
room 0 0  7 2.4
box 0.9 0.2  0.8 0.4
box 2.3 0.15  0.6 0.3
box 3.4 0.3  0.5 0.6
box 4.6 0.2  0.7 0.4
box 5.9 0.25  0.5 0.5
box 1.5 2.25  0.7 0.3
box 2.8 2.15  0.5 0.5
box 4.0 2.2  0.6 0.4
box 5.2 2.1  0.5 0.6
speed 0.3
go 0.8 1.2  2.2 1.3  3.6 1.1  5 1.2
"""
# Past the furniture of room A of rooms.world, which a laser that sees 3 m has in sight all the way.
ROOM_A = """
speed 0.15
turn_rate 20
go 2.6 2.6  1.9 1.7  3.4 1.6  3.6 1.3
"""
PROBED = {
    "scip": ("urg-04lx", "ust-10lx", "utm-30lx", "utm-30lx-ew"),
    "sick": ("lms200",),
    "rplidar": ("rplidar-a1", "rplidar-a3", "rplidar-c1", "rplidar-s1", "rplidar-s2", "rplidar-s3"),
    "ldrobot": ("ld06", "ld19", "stl-27l"),
    "ydlidar": ("ydlidar-x2", "ydlidar-x4", "ydlidar-g4", "ydlidar-tg30"),
    "sopas": ("lms111", "tim551", "tim571", "lms4124"),
    "csv": ("csv",),
}
NETWORKED = ("sopas", "csv")
SHORT_DRIVE_S = 25
DRIVE_S = float(os.environ.get("ODOLESS_DRIVE_S", SHORT_DRIVE_S))
ERROR_MAX_M = 0.05


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return free.getsockname()[1]


class LasersTest(DaemonCase):
    port = None  # of a laser on a network
    drive_s = DRIVE_S

    def robot_file(self, name, **values):
        """The robot file with its laser on the emulator's line, and nothing of the network."""
        with open(os.path.join(SOURCES, "config", name), encoding="utf-8") as file:
            text = file.read()
        for key, value in {"device": f'"{self.path("laser")}"', **values}.items():
            text, found = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
            self.assertEqual(found, 1, f"{name} has no {key}")
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(f'{text}\n[lcm]\nurl = ""\n[control]\nsocket = "{self.path("control")}"\n')
        return self.path(name)

    def network_robot_file(self, name):
        self.port = free_port()
        return self.robot_file(name, device=f'"tcp://127.0.0.1:{self.port}"')

    def start_laser(self, *more):
        if self.port is None:
            return super().start_laser(*more)
        return self.start("odoless", "emulate", "lrf", "--from", self.laser_world, "--tcp", str(self.port), *more)

    def off_m(self, path):
        """How far a path is off the true one (RMS)."""
        ate = run("odoless", "eval", "ate", self.path("truth.tum"), self.path(path), "--json")
        return json.loads(ate.stdout)["translation_m"]["rmse"]

    def start_laser_model(self, model):
        return self.start_laser("--model", model, "--start-delay-s", "1", "--truth", self.path("truth.tum"))

    def drive(self, model):
        """How many scans the daemon took, and how far the path was off as it was published at the time."""
        laser = self.start_laser_model(model)
        daemon = self.start_daemon("--enforce-realtime")
        self.wait_until_ok()
        time.sleep(self.drive_s)
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=10), 0, daemon.stderr.read())
        laser.kill()
        laser.wait()
        summary = self.summary()
        self.assertEqual(summary["heap_calls"], 0)
        return summary["scans"], self.off_m("out/latest/trajectory_online.tum")

    def drive_in_halves(self, model):
        """The same of a daemon with the filter alone; a replay of what the other half has recorded is off by no less."""
        self.forget("recorded.00000.lcm")
        laser = self.start_laser_model(model)
        filter_half = self.start_daemon("--stages", "filter")
        laser_half = self.start("odolessd", "--config", self.path("front.toml"), "--out", self.path("front"), "--stages", "sensor,matcher")
        self.wait_until_ok()
        time.sleep(self.drive_s)
        for daemon in (laser_half, filter_half):
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(timeout=10), 0, daemon.stderr.read())
        laser.kill()
        laser.wait()
        replay = run("odoless", "replay", self.path("recorded.00000.lcm"), "--out", self.path("replay"), "--force")
        self.assertEqual(replay.returncode, 0, replay.stderr)
        return self.summary()["scans"], max(self.off_m("out/latest/trajectory_online.tum"), self.off_m("replay/trajectory_online.tum"))

    def expect_maps(self, config, model, rate_hz=10.0):
        self.config = config
        self.expect(model, lambda: self.drive(model), rate_hz, ERROR_MAX_M)

    def expect(self, model, drive, rate_hz, error_max_m):
        for _ in range(3):
            with HostWatch() as host:
                scans, error_m = drive()
            print(f"  {model}: {scans} scans, {error_m:.3f} m off; the machine withheld {host.withheld_s:.2f} s")
            if error_m <= error_max_m and scans > 0.9 * rate_hz * self.drive_s:
                return
            self.assertGreater(host.withheld_s, 1.0, f"{model} is {error_m} m off after {scans} scans")
        self.fail("in three attempts the machine was too busy")

    def test_probe_finds_every_laser(self):
        addresses, probes = {}, {}
        for driver, models in PROBED.items():
            for model in models:
                address, port = self.path(model), free_port()
                line = ("--tcp", str(port)) if driver in NETWORKED else ("--pty", address)
                self.start("odoless", "emulate", "lrf", "--from", WORLD, "--model", model, "--start-at-once", *line)
                addresses[driver, model] = f"tcp://127.0.0.1:{port}" if driver in NETWORKED else address
        for address in addresses.values():
            self.wait_until(lambda path=address: path.startswith("tcp:") or os.path.lexists(path), 10)
        for laser, address in addresses.items():
            probes[laser] = self.start("odoless", "probe", address, stdout=subprocess.PIPE)
        for (driver, model), probe in probes.items():
            text, _ = probe.communicate(timeout=60)
            with self.subTest(model):
                self.assertEqual(probe.returncode, 0, text)
                self.assertIn(f'driver = "{driver}"', text)
                self.assertRegex(text, r"beams over [0-9.]+ deg, .* Hz")
                print(f"  {model}: {re.search('[0-9]+ beams over.*', text)[0]}")

    def test_maps_with_an_ld06(self):
        self.expect_maps(self.robot_file("robot-ld19.toml"), "ld06")

    def test_maps_with_an_ld19(self):
        self.expect_maps(self.robot_file("robot-ld19.toml"), "ld19")

    def test_maps_all_of_the_building_with_an_ld19(self):
        """Where it stops at once and turns on the spot, too: its scans take all of the time from one to the next."""
        self.drive_s = 70
        self.expect_maps(self.robot_file("robot-ld19.toml"), "ld19")

    def test_maps_with_an_stl_27l(self):
        self.expect_maps(self.robot_file("robot-ld19.toml", baud=921600, ldrobot_beams=1080), "stl-27l")

    def test_maps_with_a_hokuyo_of_several_echoes(self):
        self.expect_maps(self.network_robot_file("robot-utm-30lx-ew.toml"), "utm-30lx-ew", 40.0)

    def test_maps_with_a_hokuyo_on_ethernet(self):
        self.expect_maps(self.network_robot_file("robot-ust-10lx.toml"), "ust-10lx", 40.0)

    def test_maps_with_an_urg_04lx(self):
        self.laser_world = self.other_way("speed", "speed 0.9\n")  # as its robot file says
        self.expect_maps(self.robot_file("robot-urg-04lx.toml"), "urg-04lx")

    def test_maps_with_an_lms200(self):
        self.expect_maps(self.robot_file("robot-lms200.toml"), "lms200", 37.5)

    def test_maps_with_an_rplidar_c1(self):
        self.expect_maps(self.robot_file("robot-rplidar.toml", baud=460800, rplidar_beams=500), "rplidar-c1")

    def test_maps_with_an_rplidar_s1(self):
        self.expect_maps(self.robot_file("robot-rplidar.toml", baud=256000, rplidar_beams=920), "rplidar-s1")

    def test_maps_with_an_rplidar_a3(self):
        self.expect_maps(self.robot_file("robot-rplidar.toml", rplidar_beams=1440), "rplidar-a3")

    def test_maps_with_an_rplidar_s2(self):
        self.expect_maps(self.robot_file("robot-rplidar.toml", baud=1000000, rplidar_beams=1800), "rplidar-s2")

    def test_both_halves_and_a_recording_know_the_times_of_beams(self):
        url = f'url = "udpm://239.255.76.67:{free_port()}"\n'
        self.config = self.write_config("robot.toml", url=url)
        self.write_config("front.toml", f'[recorder]\npath = "{self.path("recorded")}"\n', url=url, socket="front_control",
                          lrf='driver = "rplidar"\nbaud = 1000000\nrplidar_beams = 1800\n')
        self.expect("rplidar-s2 in halves", lambda: self.drive_in_halves("rplidar-s2"), 10.0, 0.025)

    def test_maps_with_a_ydlidar_x4(self):
        self.expect_maps(self.robot_file("robot-ydlidar-x4.toml"), "ydlidar-x4", 7.0)

    def test_maps_with_a_ydlidar_x2(self):
        self.expect_maps(self.robot_file("robot-ydlidar-x4.toml", baud=115200), "ydlidar-x2", 7.0)

    def test_maps_with_a_ydlidar_g4(self):
        self.expect_maps(self.robot_file("robot-ydlidar-x4.toml", baud=230400, ydlidar_beams=900), "ydlidar-g4", 7.0)

    def test_maps_with_a_ydlidar_tg30(self):
        values = {"baud": 512000, "ydlidar_beams": 1800, "ydlidar_ranging": '"time_of_flight"'}
        self.expect_maps(self.robot_file("robot-ydlidar-x4.toml", **values), "ydlidar-tg30")

    def test_maps_with_a_tim571_in_binary(self):
        self.expect_maps(self.network_robot_file("robot-tim571.toml"), "tim571", 15.0)

    def test_maps_with_a_tim551_in_ascii(self):
        self.expect_maps(self.network_robot_file("robot-tim571.toml"), "tim551", 15.0)

    def test_maps_with_an_lms111(self):
        self.expect_maps(self.network_robot_file("robot-lms111.toml"), "lms111", 50.0)

    def test_maps_an_aisle_with_an_lms4124(self):
        self.drive_s = SHORT_DRIVE_S
        self.laser_world = self.path("aisle.world")
        with open(self.laser_world, "w", encoding="utf-8") as file:
            file.write(AISLE)
        self.expect_maps(self.network_robot_file("robot-lms4124.toml"), "lms4124", 60.0)

    def test_maps_part_of_a_room_with_an_lms4124(self):
        self.drive_s = SHORT_DRIVE_S
        self.laser_world = self.other_way(("speed", "turn_rate", "go"), ROOM_A)
        self.expect_maps(self.network_robot_file("robot-lms4124.toml"), "lms4124", 60.0)

    def test_maps_with_a_laser_of_ones_own(self):
        self.expect_maps(self.network_robot_file("robot-csv.toml"), "csv", 20.0)

    def test_hears_the_example_of_a_laser_of_ones_own(self):
        port = free_port()
        with open(os.path.join(SOURCES, "drivers", "lrf", "csv", "README.md"), encoding="utf-8") as page:
            code = "".join(line[4:] or "\n" for line in page if line.startswith("    ") or not line.strip())
        example = self.path("example.py")
        with open(example, "w", encoding="utf-8") as file:
            file.write(code[code.index("import"):].replace("5005", str(port)))
        self.config = self.robot_file("robot-csv.toml", device=f'"udp://127.0.0.1:{port}"')
        daemon = self.start_daemon()
        sender = subprocess.Popen([sys.executable, example])
        self.addCleanup(sender.wait)
        self.addCleanup(sender.kill)
        time.sleep(5)
        self.assertIsNone(sender.poll(), "the example ended")
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=10), 0, daemon.stderr.read())
        self.assertGreater(self.summary()["scans"], 20)


if __name__ == "__main__":
    main(at_once=5)  # mostly a daemon and its laser alone
