#!/usr/bin/env python3
"""Runs bench_core briefly and fails if what it measures is slower than promised.

usage: speed_test.py BENCH_CORE

All of it compares within one run, so that a slow machine, which slows all alike, does not fail it: CPU time is that of a core that scores 50 million
points a second with the exact NDT of a textbook. Of everything the fastest of some runs in turn counts, since what else runs only slows.
"""

import json
import subprocess
import sys

PLAIN_SCORE = 50e6  # points per second of the exact NDT, of the core that the promises are about
SPEED_UP_MIN = 8.0  # points per second of the raster over those of the exact NDT
CLOUD_CORE_SHARE_MAX = 0.1  # CPU time of 40 scans of 1081 beams put into the 3D map, over a second
SEED_MATCH_MAX_MS = 4.0  # CPU time of N = 100, G = 50 with the making of the reference
LASER_STREAM_MIN = 2000.0  # of a laser's stream, decoded in a second of CPU time: 0.05 % of a core


def run(program, what, min_time_s, repetitions=7):
    command = [
        program,
        f"--benchmark_filter={what}",
        f"--benchmark_min_time={min_time_s}",
        f"--benchmark_repetitions={repetitions}",
        "--benchmark_enable_random_interleaving=true",
        "--benchmark_format=json",
    ]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["benchmarks"]


def best(results, name, field, better=max):
    found = [r[field] for r in results if r["run_name"] == name and r["run_type"] == "iteration"]
    if not found:
        raise SystemExit(f"speed_test: {name} was not run")
    return better(found)


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    results = run(sys.argv[1], "BM_NdtScore|BM_SeedMatch|BM_Cloud", 0.2)
    streams = run(sys.argv[1], "BM_LaserStream|BM_NdtScore/plain", 0.03, 21)
    plain = best(results, "BM_NdtScore/plain", "items_per_second")
    product = best(results, "BM_NdtScore/product", "items_per_second")
    core, core_of_streams = (best(each, "BM_NdtScore/plain", "items_per_second") / PLAIN_SCORE for each in (results, streams))  # in terms of that one
    seed_match_ms = core * best(results, "BM_SeedMatch", "cpu_time", min)
    print(f"data: {results[0].get('label', 'unknown')}")
    print(f"this core: {core:.2f} of that of the promises, {core_of_streams:.2f} later")
    print(f"score: {plain / 1e6:.1f} and {product / 1e6:.1f} million points/s, ratio {product / plain:.1f} (at least {SPEED_UP_MIN})")
    print(f"seed match: {seed_match_ms:.2f} ms CPU (at most {SEED_MATCH_MAX_MS})")
    cloud_share = core * 40.0 * 1081.0 / best(results, "BM_Cloud/product", "items_per_second")
    plain_cloud_share = core * 40.0 * 1081.0 / best(results, "BM_Cloud/plain", "items_per_second")
    print(f"3D map: {100 * cloud_share:.2f} % of a core at 40 Hz of 1081 beams (at most {100 * CLOUD_CORE_SHARE_MAX:.0f} %), plain {100 * plain_cloud_share:.1f} %")
    lasers = {r["label"]: r["run_name"] for r in streams if "streamed_per_cpu" in r}
    decoded = {laser: best(streams, name, "streamed_per_cpu") / core_of_streams for laser, name in lasers.items()}
    slowest = min(decoded, key=decoded.get)
    print(f"laser streams: {decoded[slowest]:.0f} s of {slowest}, the slowest of {len(decoded)}, in a second of CPU time (at least {LASER_STREAM_MIN:.0f})")
    fast_enough = product / plain >= SPEED_UP_MIN and seed_match_ms <= SEED_MATCH_MAX_MS
    return 0 if fast_enough and cloud_share <= CLOUD_CORE_SHARE_MAX and decoded[slowest] >= LASER_STREAM_MIN else 1


if __name__ == "__main__":
    sys.exit(main())
