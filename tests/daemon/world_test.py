"""The world file from outside: what is mapped lasts, whatever befalls the process or the disk.

As: python3 world_test.py PROGRAMS SOURCES
"""

import contextlib
import itertools
import json
import math
import os
import random
import shutil
import signal
import sqlite3
import struct
import time

from support import WORLD, alone, main, poses, run
from truth import Truth
from world_support import WorldCase, content
from fault_matrix import measured  # found by support

EX_USAGE, EX_DATAERR, EX_UNAVAILABLE, EX_CANTCREAT, EX_CONFIG = 64, 65, 69, 73, 78
KILLS = int(os.environ.get("ODOLESS_KILLS", "10"))
RETURNS = 3
FOUND_S = 30
WRONG_M, WRONG_DEG = 0.5, 5.0
# Of rooms.world, and back to where it began, the same way round: the emulated robot never jumps.
ROUND = "go 4.5 4.1  2.6 4.1  2.6 2.4  1.9 1.7  7.2 1.7  6.8 2.6  6.8 4.1  4.5 4.1\n"
POSE_BYTES = 32


class World(WorldCase):
    def expect_as_saved(self):
        """What the world's last session says is what the daemon saved at its end."""
        self.world("check", self.path("w"))
        self.world("export", self.path("w"), "--out", self.path("again"), "--force")
        self.assertEqual(content(self.path("out/latest/trajectory.tum")), content(self.path("again/trajectory.tum")))

    def last_stamp_ns(self):
        """Of the last scan that is in the file."""
        poses = self.ask("SELECT poses FROM odometry ORDER BY id DESC LIMIT 1")
        return struct.unpack_from("<q", poses, len(poses) - POSE_BYTES)[0]

    def test_exports_what_a_replay_gave(self):
        log = self.log()
        self.assertEqual(run("odoless", "replay", log, "--out", self.path("plain"), "--world", self.path("w")).returncode, 0)
        self.world("check", self.path("w"))
        self.world("export", self.path("w"), "--out", self.path("again"))
        for name in ("trajectory.tum", "pose_graph.g2o", "map.pgm", "map.yaml"):
            self.assertEqual(content(self.path("plain/" + name)), content(self.path("again/" + name)), name)
        self.assertIn("keyframes", self.world("info", self.path("w")).stdout)
        self.world("export", self.path("w"), "--out", self.path("turned"), "--north", 0)  # what was ahead is up
        for as_it_was, turned in zip(poses(self.path("again/trajectory.tum")).values(), poses(self.path("turned/trajectory.tum")).values()):
            self.assertLess(math.dist(turned[:2], (-as_it_was[1], as_it_was[0])), 1e-5)
            self.assertAlmostEqual(math.remainder(turned[2] - as_it_was[2] - math.pi / 2, 2 * math.pi), 0.0, 5)
        self.world("compact", self.path("w"))
        self.world("export", self.path("w"), "--out", self.path("coarse"), "--resolution", 0.2)
        self.assertEqual(content(self.path("again/trajectory.tum")), content(self.path("coarse/trajectory.tum")))
        self.assertLess(len(content(self.path("coarse/map.pgm"))), len(content(self.path("again/map.pgm"))) / 4)

    # What newer visits have seen again is left out; a robot finds its way in the rest as it did before.
    def test_leaves_out_what_newer_visits_have_seen(self):
        log = self.log()
        for seed in (1, 2):
            self.replay_into("w", log, f"run{seed}", "--seed", seed)
        before, bytes_before = self.count("submap"), len(content(self.path("w")))
        self.assertIn(f"of {before} submaps are left", self.world("thin", self.path("w")).stdout)
        self.assertLess(self.count("submap"), 0.6 * before)
        self.assertLess(len(content(self.path("w"))), 0.7 * bytes_before)
        self.world("check", self.path("w"))
        self.assertEqual(self.count("session"), 2)
        self.replay_into("w", self.part_of(log, 0.33, 1.0), "run3", "--seed", 3, "--localise")
        first, third = self.poses("run1/trajectory.tum"), self.poses("run3/trajectory.tum")
        apart = [math.dist(pose, first[stamp]) for stamp, pose in third.items() if stamp in first]
        self.assertGreater(len(apart), 200)
        self.assertLess(max(apart), 0.2)
        left = self.count("submap")
        self.assertIn(f"{left} of {left} submaps are left", self.world("thin", self.path("w")).stdout)
        # Found wherever it begins.
        made = run("odoless", "eval", "places", self.path("w"), log, self.path("run1/trajectory.tum"), "--places", 8, "--json")
        self.assertEqual(made.returncode, 0, made.stderr)
        places = json.loads(made.stdout)
        self.assertEqual((len(places["places"]), places["told_in_time"], places["wrong"]), (8, 8, 0), made.stdout)
        self.assertLess(places["error_max_m"], 0.2)
        again = run("odoless", "eval", "places", self.path("w"), log, self.path("run1/trajectory.tum"), "--places", 8, "--json")
        self.assertEqual(json.loads(again.stdout), places, "the same random seed, the same places")
        with open(self.path("other.tum"), "w", encoding="utf-8") as file:
            file.write("1e9 0.0 0.0 0.0 0.0 0.0 0.0 1.0\n")
        other = run("odoless", "eval", "places", self.path("w"), log, self.path("other.tum"), "--places", 8)
        self.assertEqual(other.returncode, EX_DATAERR, other.stdout)
        self.assertIn("no pose of any scan", other.stderr)

    # The second drive through a building is found in the map of the first, and has its frame; it begins elsewhere.
    def test_goes_on_with_what_is_there(self):
        log = self.log()
        self.replay_into("w", log, "run1", "--seed", 1)
        self.replay_into("w", self.part_of(log, 0.33, 1.0), "run2", "--seed", 2)
        self.assertEqual(self.count("session"), 2)
        sessions = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertEqual(sessions[1]["joined_submaps"], sessions[0]["submaps"] + sessions[1]["submaps"])
        first, second = self.poses("run1/trajectory.tum"), self.poses("run2/trajectory.tum")
        apart = [math.dist(pose, first[stamp]) for stamp, pose in second.items() if stamp in first]
        self.assertGreater(len(apart), 200)
        self.assertLess(max(apart), 0.2)
        self.world("export", self.path("w"), "--out", self.path("again"))
        self.assertEqual(content(self.path("run2/trajectory.tum")), content(self.path("again/trajectory.tum")))
        for told in (b"path of session 1", b"path of session 2"):
            self.assertIn(told, content(self.path("again/map.svg")))
        self.assertIn(b"loop closures", content(self.path("again/pose_graph.svg")))

    # Two drives through one building, each with a world of its own: one map, in which both lie as in one drive.
    def test_merges_worlds_of_one_building(self):
        log = self.log()
        self.replay_into("a", self.part_of(log, 0.0, 0.67), "run_a")
        self.replay_into("b", self.part_of(log, 0.33, 1.0), "run_b")
        self.assertEqual(run("odoless", "replay", log, "--out", self.path("whole")).returncode, 0)
        os.mkdir(self.path(".unfinished-w"))  # of a merge that was killed
        shutil.copy(self.path("b"), self.path(".unfinished-w/world"))
        self.assertIn("session 1", self.world("merge", self.path("a"), self.path("b"), "--out", self.path("w")).stdout)
        self.world("check", self.path("w"))
        self.assertEqual(self.count("session"), 2)
        sessions = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertEqual(sessions[1]["joined_submaps"], sessions[0]["submaps"] + sessions[1]["submaps"])
        self.world("export", self.path("w"), "--out", self.path("again"))
        whole = self.poses("whole/trajectory.tum")
        for name in ("trajectory_1.tum", "trajectory.tum"):
            apart = [math.dist(pose, whole[stamp]) for stamp, pose in self.poses("again/" + name).items()]
            self.assertGreater(len(apart), 200)
            self.assertLess(max(apart), 0.2)
        before = content(self.path("w"))
        self.world("merge", self.path("a"), self.path("b"), "--out", self.path("w"), status=EX_CANTCREAT)
        self.assertIn("lacks", self.world("merge", self.path("w"), self.path("b"), "--out", self.path("c"), status=EX_DATAERR).stderr)
        self.assertEqual(content(self.path("w")), before)

    # What is not surely one building is refused, and nothing is made or changed.
    def test_refuses_to_merge_worlds_of_two_buildings(self):
        for name in ("rooms", "storey", "symmetric"):
            self.assertEqual(run("odoless", "sim", os.path.join(os.path.dirname(WORLD), name + ".world"), "--out", self.path(name + ".log")).returncode, 0)
            self.replay_into(name, self.path(name + ".log"), "run_" + name)
        before = content(self.path("rooms"))
        for first, second in itertools.permutations(("rooms", "storey", "symmetric"), 2):
            refused = self.world("merge", self.path(first), self.path(second), "--out", self.path("w"), status=EX_DATAERR)
            self.assertIn("no place is surely where it was", refused.stderr)
            self.assertIn("another building", refused.stderr)
        self.assertEqual(content(self.path("rooms")), before)
        self.assertEqual([name for name in os.listdir(self.path(".")) if name.startswith((".", "w"))], [])

    # A daemon that was killed starts where the robot is, which drives on meanwhile.
    @alone
    def test_starts_where_it_was_after_a_kill(self):
        daemon = self.start_world()
        backs_s = []
        for _ in range(RETURNS):
            self.wait_until_ok()
            time.sleep(4)
            before = self.status_json()["pose"]
            daemon.kill()
            daemon.wait()
            begin = time.monotonic()
            daemon = self.start_daemon("--world", self.path("w"))
            self.wait_until(lambda: self.state().startswith("OK"), 30)
            backs_s.append(time.monotonic() - begin)
            now = self.status_json()["pose"]
            moved_m = math.dist((before["x_m"], before["y_m"]), (now["x_m"], now["y_m"]))
            print(f"  killed at {before['x_m']:.2f}, {before['y_m']:.2f}; OK after {backs_s[-1]:.1f} s at {now['x_m']:.2f}, {now['y_m']:.2f}")
            self.assertLess(moved_m, 0.5 + 1.5 * (backs_s[-1] + 0.5))
        measured(36, "pose back", max(backs_s), "s")
        self.stop_in_time(daemon)
        sessions = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertEqual(sessions[-1]["joined_submaps"], sum(each["submaps"] for each in sessions))

    # The map that was left by a reset ends in the middle of a submap; the next start goes on with the file all the same.
    def test_goes_on_after_a_reset(self):
        daemon = self.start_world()
        self.assertEqual(self.ctl("reset").returncode, 0)
        self.wait_until(lambda: self.count_in_time("keyframe WHERE session = 2") > 1, 20)
        self.stop_in_time(daemon)
        daemon = self.start_daemon("--world", self.path("w"))
        self.wait_until(lambda: self.count_in_time("keyframe WHERE session = 3") > 0, 20)
        self.stop_in_time(daemon)
        self.world("check", self.path("w"))
        sessions = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertEqual([each["keyframes"] > 0 and each["submaps"] > 0 for each in sessions], [True] * 3)

    def test_begins_a_session_with_each_map(self):
        daemon = self.start_world()
        self.assertEqual(self.ctl("reset").returncode, 0)
        self.wait_until(lambda: self.count("session") == 2, 10)
        self.wait_until(lambda: self.ask("SELECT count(*) FROM keyframe WHERE session = 2") > 1, 10)
        self.stop_in_time(daemon)
        self.world("check", self.path("w"))
        first, second = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertGreater(first["keyframes"], 1)
        self.assertGreater(second["keyframes"], 1)

    def test_holds_what_the_daemon_mapped(self):
        daemon = run("odolessd", "--config", self.config, "--replay", self.log(), "--out", self.path("out"), "--world",
                     self.path("w"))
        self.assertEqual(daemon.returncode, 0, daemon.stderr)
        self.world("export", self.path("w"), "--out", self.path("again"))
        for name in ("trajectory.tum", "map.pgm"):
            self.assertEqual(content(self.path("out/latest/" + name)), content(self.path("again/" + name)), name)

    def test_loses_nothing_when_it_is_ended(self):
        daemon = self.start_world()
        self.wait_until_ok()
        said = self.ctl("status").stdout
        self.assertIn("world: " + self.path("w"), said)
        self.assertIn(self.status_json()["world"]["uuid"], said)
        second = run("odolessd", "--config", self.write_config("second.toml", device=self.path("none"), socket="second"), "--world", self.path("w"))
        self.assertEqual(second.returncode, EX_UNAVAILABLE, second.stderr)
        self.assertIn("in use", second.stderr)
        self.stop_in_time(daemon)
        self.assertFalse(os.path.exists(self.path("w-wal")))
        self.expect_as_saved()

    def cut_power(self):
        """Of a daemon that was killed: what it had not synced is not there."""
        for name in ("w", "w-wal"):
            if os.path.exists(self.path(name + ".synced")):
                shutil.copyfile(self.path(name + ".synced"), self.path(name))
            elif os.path.exists(self.path(name)):
                os.remove(self.path(name))
        if os.path.exists(self.path("w-shm")):
            os.remove(self.path("w-shm"))

    def expect_no_wrong_pose(self, said):
        """Of status reports: where the robot was sure of its pose, it was right. Returns how often it was sure."""
        truth = Truth(self.path("truth.tum"))
        sure = [each["pose"] for each in said if each["state"] == "OK" and each.get("pose")]
        for pose in sure:
            off_m, off_deg = truth.off(truth.stamps_us[0], round(pose["stamp_s"] * 1e6), (pose["x_m"], pose["y_m"], math.radians(pose["yaw_deg"])))
            self.assertTrue(off_m < WRONG_M and off_deg < WRONG_DEG, f"OK, and {off_m:.2f} m and {off_deg:.1f} deg wrong")
        return len(sure)

    # Each daemon goes on in the file that the one before left, every other one on a slow disk, so that many are killed in the
    # middle of a write. The robot drives on meanwhile, in a building that is known.
    @alone
    def test_a_kill_or_power_cut_at_any_moment_loses_two_seconds_at_most(self):
        chance = random.Random(17)
        self.laser_world = self.other_way("go", ROUND)
        self.replay_into("w", self.log(), "mapped")
        shutil.copyfile(self.path("w"), self.path("w.synced"))
        self.start_laser("--truth", self.path("truth.tum"))
        environment = self.faulty_disk(at=self.path("w"))
        lost_s, said = [], []
        for kill in range(KILLS):
            self.disk("slow" if kill % 2 else "sound")
            daemon = self.start_daemon("--world", self.path("w"), environment=environment)
            self.wait_until(lambda: self.count_in_time(f"odometry WHERE session = {kill + 2}") > 0, 20)
            time.sleep(chance.uniform(0.0, 2.5))
            said.append(self.status_json())
            daemon.kill()
            killed_ns = time.time_ns()
            daemon.wait()
            if chance.random() < 0.5:
                self.cut_power()
            self.world("check", self.path("w"))
            lost_s.append((killed_ns - self.last_stamp_ns()) * 1e-9)
        print(f"  {KILLS} kills and power cuts: the last {max(lost_s):.1f} s were lost at most")
        measured(36, "lost", max(lost_s), "s")
        self.assertLess(max(lost_s), 2.0)
        sessions = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertEqual(len(sessions), 1 + KILLS)
        for each in sessions:
            self.assertGreater(each["scans"], 0)
        self.disk("sound")
        self.start_daemon("--world", self.path("w"), environment=environment)
        self.wait_until(lambda: self.state().startswith("OK"), FOUND_S)
        said.append(self.status_json())
        print(f"  sure of its pose, and right: at {self.expect_no_wrong_pose(said)} of {len(said)} moments")

    # Disks

    def goes_on_beside_a_failing_disk(self, fault, reason):
        daemon = self.start_world(self.faulty_disk(at=self.path("w")))
        self.wait_until_ok()
        self.disk(fault)
        told_s = self.wait_until(lambda: "a file cannot be written" in self.state(), 10)
        print(f"  {fault}: told after {told_s:.1f} s")
        self.assertIn(reason, self.ctl("status").stdout)
        self.world("check", self.path("w"))
        kept = self.count("keyframe")
        accepted = self.status_json()["scans"]["accepted"]
        self.wait_until(lambda: self.status_json()["world"]["keyframes_not_written"] >= 3, 30)
        self.wait_until(lambda: self.status_json()["scans"]["accepted"] > accepted, 5)  # mapping goes on
        self.disk("sound")
        self.wait_until(lambda: "a file cannot be written" not in self.state(), 10)
        self.wait_until(lambda: self.count("keyframe") >= kept + 3, 10)
        self.stop_in_time(daemon)
        self.expect_as_saved()

    def test_goes_on_beside_a_full_disk(self):
        self.goes_on_beside_a_failing_disk("full", "No space left")

    def test_goes_on_beside_a_read_only_disk(self):
        self.goes_on_beside_a_failing_disk("read-only", "Read-only file system")

    def test_goes_on_beside_a_broken_disk(self):
        self.goes_on_beside_a_failing_disk("broken", "Input/output error")

    def test_says_at_the_end_what_is_not_in_the_file(self):
        daemon = self.start_world(self.faulty_disk(at=self.path("w")))
        self.wait_until_ok()
        self.disk("full")
        self.wait_until(lambda: self.status_json()["world"]["keyframes_not_written"] >= 1, 30)
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=60), EX_CANTCREAT)
        self.assertIn("keyframes of this run are not in it", daemon.stderr.read())
        self.disk("sound")
        self.world("check", self.path("w"))

    # A map that has no more room stays as it is, and the robot finds its way in it.
    def test_a_world_that_is_full_stays_as_it_is(self):
        with open(self.config, "a", encoding="utf-8") as file:
            file.write("\n[graph]\nkeyframes_max = 96\n")
        self.start_laser()
        daemon = self.start_daemon("--world", self.path("w"))
        self.wait_until(self.state, 20)
        self.wait_until(lambda: self.world_json()["mode"] == "localise", 180)
        before = content(self.path("w"))
        self.assertEqual(self.world_json()["room_used"], 1.0)
        self.wait_until(lambda: self.world_json()["place"] == "sure" and self.state().startswith("DEGRADED: the map is full"), 60)
        full = self.ctl("map")
        self.assertEqual(full.returncode, EX_DATAERR)
        self.assertIn("the map is full: raise graph.submaps_max", full.stderr)
        at = self.status_json()["pose"]
        self.wait_until(lambda: math.dist([at[k] for k in ("x_m", "y_m")], [self.status_json()["pose"][k] for k in ("x_m", "y_m")]) > 1.0, 60)
        self.stop_in_time(daemon)
        self.assertEqual(content(self.path("w")), before)

    # A robot that goes the same ways: what it has seen again goes out of the map and of the file, while it maps on.
    def test_a_world_of_the_same_ways_never_fills(self):
        with open(self.config, "a", encoding="utf-8") as file:
            file.write("\n[graph]\nsubmaps_max = 16\n")
        self.start_laser()
        daemon = self.start_daemon("--world", self.path("w"))
        self.wait_until(self.state, 20)
        most = 0.0
        for _ in range(2):
            self.wait_until(lambda: self.world_json()["room_used"] >= 0.75, 180)
            most = self.world_json()["room_used"]
            self.wait_until(lambda: self.world_json()["room_used"] < most - 0.1, 180)
            self.assertEqual(self.world_json()["mode"], "continue")
            self.assertEqual(self.world_json()["place"], "sure")
        keyframes = self.world_json()["keyframes"]
        self.wait_until(lambda: self.count("keyframe") >= keyframes, 10)
        self.wait_until(lambda: self.state() == "OK", 20)
        daemon.send_signal(signal.SIGTERM)
        self.assertIn("keyframes are left out", daemon.stderr.read())
        self.assertEqual(daemon.wait(timeout=10), 0)
        self.assertLess(self.count("submap"), 14)
        self.world("check", self.path("w"))
        self.assertEqual(self.count("session"), 1)

    def test_makes_a_file_anew_that_was_removed(self):
        daemon = self.start_world()
        before = self.count("keyframe")
        for name in ("w", "w-wal", "w-shm"):
            os.remove(self.path(name))
        self.wait_until(lambda: self.count_in_time("keyframe") >= before, 10)
        self.stop_in_time(daemon)
        self.world("check", self.path("w"))

    def test_refuses_what_is_no_world(self):
        with open(self.path("w"), "w", encoding="utf-8") as file:
            file.write("a letter to a friend, " * 100)
        letter = content(self.path("w"))
        for command in (("odolessd", "--config", self.config, "--world", self.path("w")),
                        ("odoless", "world", "check", self.path("w")), ("odoless", "world", "compact", self.path("w"))):
            outcome = run(*command)
            self.assertEqual(outcome.returncode, EX_DATAERR, outcome.stderr)
            self.assertIn("no SQLite file", outcome.stderr)
        self.assertEqual(content(self.path("w")), letter)
        elsewhere = run("odolessd", "--config", self.config, "--stages", "sensor,matcher", "--world", self.path("n"))
        self.assertEqual(elsewhere.returncode, EX_USAGE, elsewhere.stderr)
        no_graph = self.write_config("plain.toml", more="[graph]\nenabled = false\n")
        self.assertEqual(run("odolessd", "--config", no_graph, "--world", self.path("n")).returncode, EX_CONFIG)


if __name__ == "__main__":
    main()
