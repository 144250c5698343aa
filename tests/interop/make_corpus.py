#!/usr/bin/env python3
"""Makes the first inputs of the fuzz programs of logs of messages (tests/fuzz/*_corpus), which tests/tools/
message_log_test.cpp reads too: the same five scans by each format's own tools.

usage: make_corpus.py LCM_TYPES WRITE_RAWLOG NODE_MODULES, as logs_test.py has them
"""

import gzip
import pathlib
import subprocess
import sys

import logs_test
from logs_test import ROOT, ROSBAG_PYTHON, write

INFINITY = float("inf")


def scans():
    """As message_log_test.cpp expects them: all numbers are exact in single precision."""
    made = []
    for k in range(5):
        ranges_m = [1.0 + 0.25 * ((7 * i + 3 * k) % 11) for i in range(25)]
        ranges_m[7] = INFINITY
        made.append(write.Scan(1_700_000_000_100_000_000 + k * 200_000_000, -1.5, 0.125, ranges_m,
                               increment_s=0.0009765625, range_min_m=0.5, range_max_m=20.0))
    return made


def main(types, rawlog_writer, modules):
    corpus = ROOT / "tests/fuzz"
    for name in ("lcm_log", "ros_bag", "mcap", "sqlite_bag", "rawlog"):
        (corpus / f"{name}_corpus").mkdir(exist_ok=True)
    made = scans()
    folder = pathlib.Path("/tmp")
    logs_test.write_lcm_by_liblcm(corpus / "lcm_log_corpus/liblcm.lcm",
                                  [("SCAN", s.stamp_ns // 1000, logs_test.planar_lidar_bytes(types, s)) for s in made])
    write.write_json(folder / "corpus.json", made)
    for packing in ("none", "bz2", "lz4"):
        subprocess.run([ROSBAG_PYTHON, "-B", ROOT / "tests/interop/write_bag.py", folder / "corpus.json",
                        corpus / f"ros_bag_corpus/{packing}.bag", packing], check=True)
    (folder / "corpus_messages.json").write_text(logs_test.json.dumps(logs_test.mcap_messages(made)), encoding="ascii")
    for packing in ("none", "lz4", "zstd"):
        subprocess.run(["node", ROOT / "tests/interop/write_mcap.mjs", folder / "corpus_messages.json",
                        corpus / f"mcap_corpus/{packing}.mcap", packing, modules], check=True)
    write.write_db3(corpus / "sqlite_bag_corpus/rosbag2.db3", made)
    write.write_csv(folder / "corpus.csv", made)
    packed = folder / "corpus.rawlog"
    subprocess.run([rawlog_writer, folder / "corpus.csv", packed], check=True)
    (corpus / "rawlog_corpus/mrpt.rawlog").write_bytes(gzip.decompress(packed.read_bytes()))


if __name__ == "__main__":
    main(*sys.argv[1:])
