#!/usr/bin/env python3
"""Runs the example of a parameter sweep, tools/experiment/sweep, on two simulated logs and two configurations, and
again, which does nothing.

usage: sweep_test.py ODOLESS OUT
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
ROOT = pathlib.Path(__file__).resolve().parents[2]


def sweep(odoless, out, configs, logs):
    command = [str(ROOT / "tools/experiment/sweep"), str(out), " ".join(configs), *logs]
    subprocess.run(command, check=True, env={**os.environ, "ODOLESS": odoless})


def main():
    odoless = sys.argv[1]
    if shutil.which("parallel") is None:
        print("GNU parallel is not installed (tools/setup installs it): skipped")
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "room.world").write_text("room 0 0  8 6\nbox 2 2.5  1 0.5\ngo 1 1  7 1  7 3\n", encoding="utf-8")
        logs = [str(folder / f"room{seed}.log") for seed in (1, 2)]
        for seed, log in enumerate(logs, 1):
            subprocess.run([odoless, "sim", str(folder / "room.world"), "--out", log, "--seed", str(seed)], check=True)
        configs = []
        for cell_m in ("0.5", "1.0"):
            config = folder / f"cell{cell_m.replace('.', '')}.toml"
            config.write_text(f"[matcher.reference.ndt]\ncell_size_m = {cell_m}\n", encoding="utf-8")
            configs.append(str(config))
        sweep(odoless, folder / "out", configs, logs)
        results = {p: p.read_bytes() for p in folder.glob("out/*/*/matches.csv")}
        assert len(results) == 4, sorted(results)
        made = {p: p.stat().st_mtime_ns for p in results}
        sweep(odoless, folder / "out", configs, logs)
        assert made == {p: p.stat().st_mtime_ns for p in results}, "what was finished was done again"
    return 0


if __name__ == "__main__":
    sys.exit(main())
