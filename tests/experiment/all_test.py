#!/usr/bin/env python3
"""Runs `odoless experiment all --quick` as a user would: it ends well, keeps quiet in a pipe, leaves one report, and does
nothing when it is called again.

usage: all_test.py ODOLESS OUT
"""

import pathlib
import shutil
import subprocess
import sys
import time


def run(odoless, out):
    command = [odoless, "experiment", "all", "--quick", "--out", str(out)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def main():
    odoless, out = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(out, ignore_errors=True)
    first = run(odoless, out)
    print(first.stdout, first.stderr)
    assert first.returncode == 0, first.returncode
    assert first.stderr == "", "a progress bar in a pipe"
    report = (out / "report.html").read_bytes()
    begin = time.monotonic()
    again = run(odoless, out)
    assert again.stdout == first.stdout
    assert (out / "report.html").read_bytes() == report, "the same inputs gave another report"
    assert time.monotonic() - begin < 10.0, "what was finished was done again"
    svgs = list(out.glob("*/figure-*.svg"))
    assert len(svgs) >= 18, len(svgs)
    for svg in svgs:
        assert svg.with_suffix(".png").read_bytes().startswith(b"\x89PNG"), svg


if __name__ == "__main__":
    main()
