#!/usr/bin/env python3
"""One log in many formats gives the same scans and the same trajectory; damaged, it is refused or read, never a crash.

usage: logs_test.py ODOLESS LCM_TYPES [WRITE_RAWLOG]

Besides the writers of tests/support, each format's own tools write it where they are: liblcm, ROS's rosbag
(python3-rosbag), @mcap/core (npm; its node_modules folder in ODOLESS_NODE_MODULES), SQLite, MRPT (WRITE_RAWLOG).
What `replay --mcap` writes is read by @mcap/core with @foxglove/rosmsg and @foxglove/rosmsg2-serialization from there.
"""

import base64
import ctypes
import ctypes.util
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import log_writers as write  # noqa: E402

SCANS = 200
DAMAGED = 100
TOLERANCE = 1e-6
EX_DATAERR = 65
ROSBAG_PYTHON = "/usr/bin/python3"  # Debian's, which has Debian's packages


class Failure(Exception):
    pass


def expect(holds, what):
    if not holds:
        raise Failure(what)


class LcmEvent(ctypes.Structure):
    _fields_ = [("eventnum", ctypes.c_int64), ("timestamp", ctypes.c_int64), ("channellen", ctypes.c_int32),
                ("datalen", ctypes.c_int32), ("channel", ctypes.c_char_p), ("data", ctypes.c_char_p)]


def planar_lidar_bytes(types, scan):
    sys.path.insert(0, str(types))
    from bot_core.planar_lidar_t import planar_lidar_t  # made by lcm-gen

    message = planar_lidar_t()
    message.utime = scan.stamp_ns // 1000
    message.ranges = [r if r < scan.range_max_m else float("inf") for r in scan.ranges_m]
    message.nranges = len(message.ranges)
    message.rad0 = scan.start_rad
    message.radstep = scan.step_rad
    return message.encode()


def write_lcm_by_liblcm(path, events):
    lcm = ctypes.CDLL(ctypes.util.find_library("lcm") or "liblcm.so.1")
    lcm.lcm_eventlog_create.restype = ctypes.c_void_p
    log = ctypes.c_void_p(lcm.lcm_eventlog_create(str(path).encode(), b"w"))
    for channel, time_us, data in events:
        event = LcmEvent(0, time_us, len(channel), len(data), channel.encode(), data)
        expect(lcm.lcm_eventlog_write_event(log, ctypes.byref(event)) == 0, "liblcm writes an event")
    lcm.lcm_eventlog_destroy(log)


def mcap_messages(scans):
    messages = []
    for scan in scans:
        for topic, kind, data in (("/chatter", "std_msgs/msg/String", b"\0\1\0\0\3\0\0\0hi\0"),
                                  ("/scan", "sensor_msgs/msg/LaserScan", write.laser_scan_cdr(scan))):
            messages.append({"topic": topic, "type": kind, "stamp_ns": str(scan.stamp_ns),
                             "data": base64.b64encode(data).decode()})
    return messages


class Test:
    def __init__(self, odoless, types, rawlog_writer):
        self.odoless = odoless
        self.types = types
        self.rawlog_writer = rawlog_writer
        self.folder = None
        self.logs = {}  # name: path

    def run(self, *arguments):
        return subprocess.run([self.odoless, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              check=False, timeout=120)

    def path(self, name):
        return self.folder / name

    def write_carmen(self):
        simulated = self.path("simulated.log")
        expect(self.run("sim", ROOT / "tools/worlds/rooms.world", "--out", simulated).returncode == 0, "sim")
        with open(simulated, encoding="ascii") as log:
            lines = [line.split() for line in log if line.startswith("FLASER")][:SCANS]
        for number, line in enumerate(lines):  # stamps as a robot's clock gives them
            stamp_us = 1_600_000_000_123_457 + number * 200_000 + number * 7919 % 5000
            line[-3] = line[-1] = f"{stamp_us // 10**6}.{stamp_us % 10**6:06d}"
        self.logs["carmen"] = self.path("carmen.log")
        self.logs["carmen"].write_text("".join(" ".join(line) + "\n" for line in lines), encoding="ascii")
        scans = write.read_flaser(self.logs["carmen"], SCANS)
        expect(len(scans) == SCANS, f"{len(scans)} scans were simulated")
        return scans

    def write_by_hand(self, scans):
        """From the formats' descriptions."""
        for packing in ("none", "bz2", "lz4"):
            write.write_bag(self.new(f"bag {packing}", "bag"), scans, packing)
        for packing in ("", "lz4", "zstd"):
            write.write_mcap(self.new(f"mcap {packing}", "mcap"), scans, packing)
        write.write_mcap(self.new("mcap big end first", "mcap"), scans, representation=0)
        write.write_mcap(self.new("mcap XCDR2", "mcap"), scans, representation=7)
        write.write_db3(self.new("db3", "db3"), scans)
        for version, pose, is_old in ((3, 0, True), (5, 1, False), (6, 2, False), (7, 3, False)):
            write.write_rawlog(self.new(f"rawlog {version}", "rawlog"), scans, version=version, pose=pose, is_old=is_old)
        events = [("SCAN", s.stamp_ns // 1000, planar_lidar_bytes(self.types, s)) for s in scans]
        write.write_lcm(self.new("lcm", "lcm"), events)
        write.write_csv(self.new("csv", "csv"), scans)

    def write_by_their_tools(self, scans):
        events = [("SCAN", s.stamp_ns // 1000, planar_lidar_bytes(self.types, s)) for s in scans]
        write_lcm_by_liblcm(self.new("lcm by liblcm", "lcm"), events)
        if self.rawlog_writer:
            subprocess.run([self.rawlog_writer, self.logs["csv"], self.new("rawlog by MRPT", "rawlog")], check=True)
        else:
            print("skipped: libmrpt-hwdrivers-dev is not installed: no rawlog by MRPT itself")
        json_path = self.path("scans.json")
        write.write_json(json_path, scans)
        if subprocess.run([ROSBAG_PYTHON, "-c", "import rosbag, sensor_msgs"], capture_output=True,
                          check=False).returncode == 0:
            for packing in ("none", "bz2", "lz4"):
                subprocess.run([ROSBAG_PYTHON, "-B", ROOT / "tests/interop/write_bag.py", json_path,
                                self.new(f"bag {packing} by rosbag", "bag"), packing], check=True)
        else:
            print("skipped: python3-rosbag and python3-sensor-msgs are not installed: no bag by ROS itself")
        modules = os.environ.get("ODOLESS_NODE_MODULES", "")
        if modules:
            messages = self.path("messages.json")
            messages.write_text(json.dumps(mcap_messages(scans)), encoding="ascii")
            for packing in ("none", "lz4", "zstd"):
                subprocess.run(["node", ROOT / "tests/interop/write_mcap.mjs", messages,
                                self.new(f"mcap {packing} by @mcap/core", "mcap"), packing, modules], check=True)
        else:
            print("skipped: ODOLESS_NODE_MODULES names no folder with npm's @mcap/core: no MCAP by its own library")

    def new(self, name, kind):
        self.logs[name] = self.path(f"{name.replace(' ', '_').replace('/', '_')}.{kind}")
        return self.logs[name]

    def trajectory(self, name):
        out = self.path("out")
        done = self.run("replay", self.logs[name], "--force", "--out", out)
        expect(done.returncode == 0, f"{name}: replay ends with {done.returncode}: {done.stderr.decode()}")
        lines = (out / "trajectory.tum").read_text(encoding="ascii").splitlines()
        return [[float(word) for word in line.split()] for line in lines if not line.startswith("#")]

    def test_same_trajectory(self):
        """@return  The trajectory."""
        plain = self.trajectory("carmen")
        expect(len(plain) > SCANS / 2, "the CARMEN log has a trajectory")
        for name in self.logs:
            other = self.trajectory(name)
            expect(len(other) == len(plain), f"{name}: {len(other)} poses, CARMEN has {len(plain)}")
            worst = max(abs(a - b) for pose, same in zip(plain, other) for a, b in zip(pose, same))
            expect(worst <= TOLERANCE, f"{name}: differs by {worst} from CARMEN")
            print(f"holds  {name}: {len(other)} poses, at most {worst:.1e} from CARMEN's")
        return plain

    def test_written_mcap(self, plain):
        """What `replay --mcap` writes: read back it is the same log, and @mcap/core finds nothing wrong with it."""
        out = self.path("written")
        done = self.run("replay", self.logs["carmen"], "--mcap", "--out", out)
        expect(done.returncode == 0, f"replay --mcap: {done.stderr.decode()}")
        self.logs["written by odoless"] = out / "replay.mcap"
        expect(self.trajectory("written by odoless") == plain, "the log written reads back as another")
        print("holds  replay --mcap: reads back as the same log")
        modules = os.environ.get("ODOLESS_NODE_MODULES", "")
        if not modules:
            return
        told = json.loads(subprocess.run(["node", ROOT / "tests/interop/read_mcap.mjs", out / "replay.mcap", modules],
                                         check=True, stdout=subprocess.PIPE).stdout)
        topics = told["topics"]
        expect(set(topics) == {"/scan", "/tf", "/pose", "/diagnostics", "/map", "/path"}, f"topics: {topics.keys()}")
        expect([topics[t]["messages"] for t in ("/scan", "/tf", "/pose")] == 3 * [len(plain)], "one of each per scan")
        frames = [(t["header"]["frame_id"], t["child_frame_id"]) for t in topics["/tf"]["last"]["transforms"]]
        expect(frames == [("map", "odom"), ("odom", "laser")], f"frames: {frames}")
        path = [pose["pose"]["position"] for pose in topics["/path"]["last"]["poses"]]
        worst = max(max(abs(p["x"] - q[1]), abs(p["y"] - q[2])) for p, q in zip(path, plain))
        expect(len(path) == len(plain) and worst <= TOLERANCE, f"/path ends as the trajectory: {len(path)}, {worst}")
        grid = topics["/map"]["last"]
        expect(len(grid["data"]) == grid["info"]["width"] * grid["info"]["height"] and set(grid["data"]) - {-1},
               "/map is a grid with something in it")
        print("holds  replay --mcap: @mcap/core reads every message, by the index as from front to back")

    def test_damaged(self):
        for name, path in self.logs.items():
            if name not in ("carmen", "lcm", "bag none", "bag lz4", "mcap ", "mcap zstd", "db3", "rawlog 7",
                            "written by odoless"):
                continue
            whole = path.read_bytes()
            refused = 0
            for seed in range(DAMAGED):
                damaged = self.path(f"damaged{path.suffix}")
                damaged.write_bytes(damage(whole, random.Random(seed)))
                done = self.run("info", damaged)
                said = done.stdout.decode(errors="replace") + done.stderr.decode(errors="replace")
                expect(done.returncode in (0, EX_DATAERR), f"{name}, seed {seed}: status {done.returncode}: {said}")
                expect(done.returncode == 0 or "; expected " in said, f"{name}, seed {seed}: refused without a word: {said}")
                refused += done.returncode != 0
            print(f"holds  {name}: of {DAMAGED} damaged ones {refused} are refused with a word, the others read")

    def test_topics(self, scans):
        two = self.path("two.mcap")
        write.write_mcap(two, scans, topics=("/front", "/rear"))
        done = self.run("replay", two, "--out", self.path("out"))
        expect(done.returncode == EX_DATAERR and b"--topic with one of /front" in done.stderr and b"/rear" in done.stderr,
               f"several topics: {done.stderr.decode()}")
        done = self.run("info", two)
        expect(done.returncode == 0 and done.stdout.count(b"topic  ") == 2, f"info lists topics: {done.stdout.decode()}")
        done = self.run("info", two, "--topic", "/rear", "--json")
        told = json.loads(done.stdout)
        expect(told["scans"] == SCANS and [t["messages"] for t in told["topics"]] == [SCANS, SCANS], f"info --json: {told}")
        done = self.run("info", two, "--topic", "/left")
        expect(done.returncode == EX_DATAERR and b"/front" in done.stderr, f"an unknown topic: {done.stderr.decode()}")
        print("holds  several topics: listed, chosen with --topic")

    def main(self):
        with tempfile.TemporaryDirectory(prefix="odoless-logs-") as folder:
            self.folder = pathlib.Path(folder)
            scans = self.write_carmen()
            self.write_by_hand(scans)
            self.write_by_their_tools(scans)
            plain = self.test_same_trajectory()
            self.test_topics(scans)
            self.test_written_mcap(plain)
            self.test_damaged()


def damage(whole, chance):
    """One kind of damage that files suffer."""
    data = bytearray(whole)
    kind = chance.randrange(4)
    at = chance.randrange(len(data))
    length = 1 + chance.randrange(64)
    if kind == 0:
        return bytes(data[:at])
    if kind == 1:
        for _ in range(length):
            data[chance.randrange(len(data))] = chance.randrange(256)
    elif kind == 2:
        del data[at:at + length]
    else:
        data[at:at + length] = bytes(length)
    return bytes(data)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        print(__doc__, file=sys.stderr)
        sys.exit(64)
    try:
        Test(sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3] if len(sys.argv) > 3 else None).main()
    except Failure as failure:
        print(f"FAILS  {failure}")
        sys.exit(1)
