#!/usr/bin/env python3
"""Holds the dissertation's statements against the numbers that the experiments wrote, by its own arithmetic: it reads the CSV
files, and then asks that the report's verdict is the same.

usage: statements_test.py ODOLESS OUT
"""

import csv
import json
import math
import pathlib
import statistics
import sys

GROSS_M = 0.2
GROSS_RAD = math.radians(5.0)


class Errors:
    """Errors of displacement of one setting."""

    def __init__(self, rows, label):
        self.translations_m = [math.hypot(float(r[f"{label} error_x_m"]), float(r[f"{label} error_y_m"])) for r in rows]
        self.rotations_rad = [abs(float(r[f"{label} error_yaw_rad"])) for r in rows]

    def gross(self):
        return sum(t > GROSS_M or r > GROSS_RAD for t, r in zip(self.translations_m, self.rotations_rad))

    def median_m(self):
        return statistics.median(self.translations_m)


class Statements:
    def __init__(self, out):
        self.out = out
        self.failures = []

    def rows(self, experiment, table):
        with open(self.out / experiment / f"{table}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def errors(self, experiment, labels):
        rows = self.rows(experiment, "errors")
        return [Errors(rows, label) for label in labels]

    def hold(self, holds, what):
        print("holds" if holds else "FAILS", what)
        if not holds:
            self.failures.append(what)

    def verdict(self, experiment, stated, expected=True):
        """The report's own verdict on the statement that begins like that."""
        claims = json.loads((self.out / experiment / "result.json").read_text(encoding="utf-8"))["claims"]
        found = [claim for claim in claims if claim["stated"].startswith(stated)]
        self.hold(len(found) == 1 and found[0]["agrees"] == expected, f"the report says so: {stated}")


def check_population(s):
    n20, n40, n60, n100 = s.errors("population", ["N 20", "N 40", "N 60", "N 100"])
    s.hold(n20.gross() > 0 and n40.gross() > 0, f"N = 20 and 40 fail: {n20.gross()}, {n40.gross()}")
    s.hold(n100.gross() == 0, f"N = 100 does not: {n100.gross()}, and 60: {n60.gross()}")
    s.hold(n100.median_m() <= 0.010, f"median {n100.median_m():.4f} m")
    s.hold(statistics.median(n100.rotations_rad) <= math.radians(0.1), "median 0.1 deg")
    s.hold(max(n100.translations_m) <= 0.2, f"worst {max(n100.translations_m):.3f} m")
    s.verdict("population", "small populations")
    s.verdict("population", "a population of 100 converges")


def check_generations(s):
    medians = [e.median_m() for e in s.errors("generations", ["G 15", "G 30", "G 50", "G 75"])]
    s.hold(all(a > b for a, b in zip(medians, medians[1:])), f"more generations refine: {medians}")
    s.verdict("generations", "more generations")


def check_noise(s):
    errors = s.errors("noise", ["sd (mm) 15", "sd (mm) 25", "sd (mm) 40", "sd (mm) 80"])
    medians = [e.median_m() for e in errors]
    s.hold(all(a < b for a, b in zip(medians, medians[1:])), f"the error grows with the noise: {medians}")
    s.hold(all(e.gross() <= 0.02 * len(e.translations_m) for e in errors), f"robust: {[e.gross() for e in errors]}")
    s.verdict("noise", "our aim: what is built in beats")


def check_drift(s):
    alone = [float(r["error_m"]) for r in s.rows("drift", "paths")]
    filtered = [float(r["error_m"]) for r in s.rows("dpslam", "path")]
    third = len(alone) // 3
    s.hold(max(alone[-third:]) > max(alone[:third]), f"matches alone drift: {max(alone):.3f} m")
    small = sum(e < 0.3 for e in filtered) / len(filtered)
    s.hold(small >= 0.9, f"DP-SLAM is mostly under 300 mm: {100 * small:.1f} %, worst {max(filtered):.3f} m")
    s.hold(max(filtered) < max(alone), "DP-SLAM drifts less")
    s.verdict("drift", "by scan matching alone")
    s.verdict("dpslam", "with DP-SLAM the error does not increase")


def check_recorded(s):
    if not (s.out / "dwing").exists():
        print("no recorded logs here (ODOLESS_DATA): D-Wing and sparse scans were not tried")
        return
    fitness = [float(r["fitness_seed"]) for r in s.rows("dwing", "fitness-built-in")]
    s.hold(max(fitness) < 30.0, f"D-Wing's fitness stays below 30 as built in: {max(fitness):.1f}")
    s.verdict("sparse", "scans far apart need cells of 4000 mm")


def check_cloud(s):
    rows = s.rows("cloud", "points")
    distances_m = sorted(float(r["distance_to_truth_m"]) for r in rows)
    median_m, most_m = statistics.median(distances_m), distances_m[int(0.95 * len(distances_m))]
    s.hold(len(rows) > 5000 and median_m <= 0.020 and most_m <= 0.060,
           f"the 3D map lies on its building: {len(rows)} points, median {median_m:.4f} m, 95 % within {most_m:.4f} m")
    columns = {}  # of space, 0.25 m wide; where nothing stands, what is low is floor
    for r in rows:
        columns.setdefault((float(r["x_m"]) // 0.25, float(r["y_m"]) // 0.25), []).append(float(r["z_m"]))
    free = [column for column in columns.values() if not any(0.2 < z_m < 1.2 for z_m in column)]
    floor_m = sorted(abs(z_m) for column in free for z_m in column if abs(z_m) <= 0.2)
    s.hold(len(floor_m) > 500 and floor_m[int(0.95 * len(floor_m))] <= 0.020,
           f"its floor is flat: 95 % of {len(floor_m)} points within {floor_m[int(0.95 * len(floor_m))]:.4f} m")
    s.verdict("cloud", "the trajectory of 2D DP-SLAM can be used")
    s.verdict("cloud", "our aim: the floor is flat")


def main():
    s = Statements(pathlib.Path(sys.argv[2]))
    for check in (check_population, check_generations, check_noise, check_drift, check_cloud, check_recorded):
        check(s)
    return 1 if s.failures else 0


if __name__ == "__main__":
    sys.exit(main())
