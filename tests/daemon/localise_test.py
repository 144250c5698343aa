"""A world that stays as it is, in which the robot only finds its way, from outside.

As: python3 localise_test.py PROGRAMS SOURCES
"""

import bisect
import json
import math
import os
import time

from support import main, poses, run
from world_support import WorldCase, content

EX_USAGE, EX_DATAERR, EX_NOINPUT, EX_CONFIG = 64, 65, 66, 78
FOUND_S = 30
WAY_M = 0.2


class Localise(WorldCase):
    def map_rooms(self):
        """A world of the whole drive, which nobody may write."""
        log = self.log()
        self.replay_into("w", log, "run1", "--seed", 1)
        os.chmod(self.path("w"), 0o444)
        return log

    def apart_m(self):
        """Of the saved trajectory's poses from the truth. Both drives begin at the same place, where the world's frame is."""
        truth, estimate = poses(self.path("truth.tum")), poses(self.path("out/latest/trajectory.tum"))
        stamps_us = sorted(truth)
        x, y, yaw = truth[stamps_us[0]]
        apart = []
        for stamp_us, (at_x, at_y, _) in estimate.items():
            after = bisect.bisect(stamps_us, stamp_us)
            if 0 < after < len(stamps_us):
                before_us, after_us = stamps_us[after - 1], stamps_us[after]
                share = (stamp_us - before_us) / (after_us - before_us)
                true_x, true_y = ((1 - share) * truth[before_us][i] + share * truth[after_us][i] for i in (0, 1))
                east, north = true_x - x, true_y - y
                apart.append(math.hypot(math.cos(yaw) * east + math.sin(yaw) * north - at_x, math.cos(yaw) * north - math.sin(yaw) * east - at_y))
        return apart

    # The second drive begins elsewhere. It is found, and the file is the same to the last byte.
    def test_finds_the_way_and_leaves_the_world_as_it_is(self):
        log = self.map_rooms()
        before = content(self.path("w"))
        self.replay_into("w", self.part_of(log, 0.33, 1.0), "run2", "--seed", 2, "--localise")
        self.assertEqual(content(self.path("w")), before)
        self.assertEqual([name for name in os.listdir(self.path("")) if name.startswith("w-")], [], "nothing beside it")
        first, second = self.poses("run1/trajectory.tum"), self.poses("run2/trajectory.tum")
        apart = [math.dist(pose, first[stamp]) for stamp, pose in second.items() if stamp in first]
        self.assertGreater(len(apart), 200)
        self.assertLess(max(apart), WAY_M)
        with open(self.path("run2/summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        print(f"  {summary['unlocated_scans']} scans until something was known, {summary['guessed_scans']} of a guess; at most {max(apart):.3f} m apart")
        self.assertLess(summary["unlocated_scans"] + summary["guessed_scans"], 0.3 * len(second))

    # The daemon finds the robot by itself; a pose that somebody says, right or wrong, is tried and not believed.
    def test_a_daemon_finds_the_robot_and_takes_no_word_for_it(self):
        self.map_rooms()
        before = content(self.path("w"))
        self.start_laser("--truth", self.path("truth.tum"))
        daemon = self.start_daemon("--world", self.path("w"), "--localise")
        self.wait_until(lambda: self.state().startswith("OK"), FOUND_S)
        self.assertIn("it stays as it is", self.answer("status"))
        self.assertEqual(self.status_json()["world"]["mode"], "localise")
        pose = self.status_json()["pose"]
        answer = self.ctl("pose", f"{pose['x_m'] + 3.0:.2f}", f"{pose['y_m'] + 3.0:.2f}", "0")
        self.assertIn("looked for", answer.stdout)
        self.wait_until(lambda: not self.state().startswith("OK"), 5)
        self.wait_until(lambda: self.state().startswith("OK"), FOUND_S)
        time.sleep(1)
        self.stop_in_time(daemon)
        self.assertEqual(content(self.path("w")), before)
        apart = self.apart_m()
        print(f"  at most {max(apart):.3f} m from the truth, over {len(apart)} poses")
        self.assertLess(max(apart), WAY_M)

    def test_a_reset_looks_for_the_robot_anew(self):
        self.map_rooms()
        self.start_laser()
        daemon = self.start_daemon("--world", self.path("w"), "--localise")
        self.wait_until(lambda: self.state().startswith("OK"), FOUND_S)
        self.assertEqual(self.ctl("reset").returncode, 0)
        self.wait_until(lambda: self.state().startswith("LOST"), 5)
        self.wait_until(lambda: self.state().startswith("OK"), FOUND_S)
        self.stop_in_time(daemon)

    # A robot that maps, then only finds its way in what it has mapped, then maps again: one map, and always OK.
    def test_goes_over_and_back_while_it_runs(self):
        self.start_laser("--truth", self.path("truth.tum"))
        daemon = self.start_daemon("--world", self.path("w"))
        self.wait_until(self.state, 20)
        self.wait_until(lambda: self.world_json()["submaps"] > 2 and self.state().startswith("OK"), 60)
        self.assertIn("the map grows", self.answer("world"))
        self.assertIn("localise: the map stays as it is", self.go_over("localise"))
        before, world = content(self.path("w")), self.world_json()
        self.assertEqual((world["mode"], world["place"], world["error"]), ("localise", "sure", ""))
        self.assertEqual(self.count("keyframe"), world["keyframes"])
        self.assertEqual(self.status_json()["world"]["mode"], "localise")
        self.assertIn("that is what it does", self.answer("localise"))
        at = self.status_json()["pose"]
        self.wait_until(lambda: math.dist([at[k] for k in ("x_m", "y_m")], [self.status_json()["pose"][k] for k in ("x_m", "y_m")]) > 1.0, 60)
        self.assertEqual(content(self.path("w")), before)
        self.assertIn("continue: the map grows", self.go_over("map"))
        self.wait_until(lambda: self.world_json()["place"] == "sure", FOUND_S)
        self.wait_until(lambda: self.world_json()["submaps"] > world["submaps"] + 1, 60)
        self.stop_in_time(daemon)
        self.world("check", self.path("w"))
        sessions = json.loads(self.world("info", self.path("w"), "--json").stdout)["sessions"]
        self.assertEqual(len(sessions), 2)
        self.assertEqual(sessions[-1]["joined_submaps"], sum(each["submaps"] for each in sessions))
        apart = self.apart_m()
        print(f"  at most {max(apart):.3f} m from the truth, over {len(apart)} poses")
        self.assertLess(max(apart), WAY_M)

    def test_maps_no_more_into_a_file_that_is_another(self):
        self.start_laser()
        daemon = self.start_daemon("--world", self.path("w"))
        self.wait_until(self.state, 20)
        self.wait_until(lambda: self.world_json()["keyframes"] > 3, 60)
        self.go_over("localise")
        os.rename(self.path("w"), self.path("aside"))
        refused = self.ctl("map")
        self.assertEqual(refused.returncode, EX_DATAERR)
        self.assertIn("it is not there any more", refused.stderr)
        self.assertIn("mapping does not go on: it is not there any more", self.answer("world"))
        os.rename(self.path("aside"), self.path("w"))
        self.go_over("map")
        self.stop_in_time(daemon)

    # Without a file the map in memory is what the robot finds its way in.
    def test_goes_over_without_a_file(self):
        self.start_laser()
        daemon = self.start_daemon()
        self.wait_until(self.state, 20)
        self.wait_until(lambda: self.world_json()["keyframes"] > 3, 60)
        self.assertIn("in memory alone", self.go_over("localise"))
        self.assertEqual(self.world_json()["mode"], "localise")
        self.go_over("map")
        self.assertEqual(self.world_json()["mode"], "continue")
        self.stop_in_time(daemon)

    def test_refuses_a_world_without_a_map(self):
        def daemon(*options):
            return run("odolessd", "--config", self.config, *options)

        missing = daemon("--world", self.path("none"), "--localise")
        self.assertEqual(missing.returncode, EX_NOINPUT, missing.stderr)
        self.assertIn("a world file is needed, with a map", missing.stderr)
        self.assertFalse(os.path.exists(self.path("none")))
        self.assertEqual(daemon("--localise").returncode, EX_CONFIG)
        empty = self.path("empty")
        begun = self.start_daemon("--world", empty)
        self.wait_until(self.state, 10)
        self.stop_in_time(begun)
        nothing = daemon("--world", empty, "--localise")
        self.assertEqual(nothing.returncode, EX_DATAERR, nothing.stderr)
        self.assertIn("there is no map in it yet", nothing.stderr)
        log = self.log()
        self.assertEqual(run("odoless", "replay", log, "--out", self.path("r"), "--localise").returncode, EX_USAGE)
        gone = run("odoless", "replay", log, "--out", self.path("r"), "--localise", "--world", self.path("none"))
        self.assertEqual(gone.returncode, EX_NOINPUT, gone.stderr)


if __name__ == "__main__":
    main()
