"""Writes laser scans as logs of several formats: written from the formats' descriptions and not from our readers, and
beside the formats' own tools, which are not everywhere."""

import bz2
import gzip
import json
import math
import sqlite3
import struct
import subprocess
import zlib
from dataclasses import asdict, dataclass, field

LASER_SCAN_SUM = "90c7ef2dc6895d81024acba2ac42f369"
NO_RETURN_M = 81.8
RAD_PER_DEG = math.pi / 180.0


@dataclass
class Scan:
    stamp_ns: int
    start_rad: float
    step_rad: float
    ranges_m: list = field(default_factory=list)
    increment_s: float = 0.0
    range_min_m: float = 0.0
    range_max_m: float = NO_RETURN_M


def read_flaser(path, count):
    """The first scans of a CARMEN log with 180 or 181 beams each."""
    scans = []
    with open(path, encoding="ascii") as log:
        for line in log:
            words = line.split()
            if len(scans) == count or not words or words[0] != "FLASER":
                continue
            beams = int(words[1])
            seconds, _, micro = words[2 + beams + 6].partition(".")
            stamp_ns = int(seconds) * 10**9 + int(micro.ljust(9, "0")[:9])
            scans.append(Scan(stamp_ns, -math.pi / 2, RAD_PER_DEG, [float(w) for w in words[2:2 + beams]]))
    return scans


def write_json(path, scans):
    path.write_text(json.dumps([asdict(scan) for scan in scans]), encoding="ascii")


def write_csv(path, scans):
    with open(path, "w", encoding="ascii") as out:
        for s in scans:
            head = [f"{s.stamp_ns // 10**9}.{s.stamp_ns % 10**9:09d}", repr(s.start_rad), repr(s.step_rad),
                    repr(s.increment_s), "0", repr(s.range_min_m), repr(s.range_max_m), str(len(s.ranges_m))]
            out.write(",".join(head + [repr(r) for r in s.ranges_m]) + "\n")


def floats(values, order="<"):
    return struct.pack(f"{order}{len(values)}f", *values)


def packed(how, data):
    if how == "bz2":
        return bz2.compress(data)
    if how in ("lz4", "zstd"):
        return subprocess.run([how, "-c", "-q"], input=data, stdout=subprocess.PIPE, check=True).stdout
    return data


# LCM: an event each, highest byte first.


def write_lcm(path, events):
    """`events`: (channel, time in us, bytes)."""
    with open(path, "wb") as out:
        for number, (channel, time_us, data) in enumerate(events):
            out.write(struct.pack(">IqqII", 0xEDA1DA01, number, time_us, len(channel), len(data)))
            out.write(channel.encode() + data)


# ROS


def laser_scan_numbers(s):
    beams = len(s.ranges_m)
    return [s.start_rad, s.start_rad + (beams - 1) * s.step_rad, s.step_rad, s.increment_s, 0.0, s.range_min_m,
            s.range_max_m]


def laser_scan_ros1(s, sequence=0, frame="laser"):
    seconds, rest = divmod(s.stamp_ns, 10**9)
    count = struct.pack("<I", len(s.ranges_m))
    return (struct.pack("<IIII", sequence, seconds, rest, len(frame)) + frame.encode() + floats(laser_scan_numbers(s)) +
            count + floats(s.ranges_m) + struct.pack("<I", 0))


def laser_scan_cdr(s, representation=1, frame="laser"):
    order = "<" if representation % 2 else ">"
    seconds, rest = divmod(s.stamp_ns, 10**9)
    text = frame.encode() + b"\0"
    body = struct.pack(f"{order}iII", seconds, rest, len(text)) + text
    body += b"\0" * (-len(body) % 4)
    body += floats(laser_scan_numbers(s), order) + struct.pack(f"{order}I", len(s.ranges_m))
    body += floats(s.ranges_m, order) + struct.pack(f"{order}I", 0)
    return struct.pack(">HH", representation, 0) + body


def bag_record(fields, data):
    header = b"".join(struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value
                      for name, value in fields.items())
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def bag_fields(fields):
    return b"".join(struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value
                    for name, value in fields.items())


def bag_connection(number, topic, kind, md5sum):
    details = bag_fields({"topic": topic.encode(), "type": kind.encode(), "md5sum": md5sum.encode(),
                          "message_definition": b"# left out"})
    return bag_record({"op": b"\x07", "conn": struct.pack("<I", number), "topic": topic.encode()}, details)


def write_bag(path, scans, packing="none", topics=("/scan",), per_chunk=50):
    connections = [bag_connection(i, topic, "sensor_msgs/LaserScan", LASER_SCAN_SUM) for i, topic in enumerate(topics)]
    body = b""
    chunks = 0
    for begin in range(0, len(scans), per_chunk):
        inside = b"".join(connections) if begin == 0 else b""
        for s in scans[begin:begin + per_chunk]:
            seconds, rest = divmod(s.stamp_ns, 10**9)
            for number in range(len(topics)):
                inside += bag_record({"op": b"\x02", "conn": struct.pack("<I", number),
                                      "time": struct.pack("<II", seconds, rest)}, laser_scan_ros1(s))
        body += bag_record({"op": b"\x05", "compression": packing.encode(), "size": struct.pack("<I", len(inside))},
                           packed(packing, inside))
        body += bag_record({"op": b"\x04", "ver": struct.pack("<I", 1), "conn": struct.pack("<I", 0),
                            "count": struct.pack("<I", 0)}, b"")
        chunks += 1
    magic = b"#ROSBAG V2.0\n"
    counts = {"op": b"\x03", "index_pos": struct.pack("<Q", len(magic) + 4096 + len(body)),
              "conn_count": struct.pack("<I", len(topics)), "chunk_count": struct.pack("<I", chunks)}
    head = bag_record(counts, b"")
    padding = 4096 - len(head)
    head = bag_record(counts, b" " * padding)
    path.write_bytes(magic + head + body + b"".join(connections))


def mcap_record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def write_mcap(path, scans, packing="", topics=("/scan",), per_chunk=50, representation=1):
    schema = mcap_record(3, struct.pack("<H", 1) + text("sensor_msgs/msg/LaserScan") + text("ros2msg") + text("# left out"))
    channels = b"".join(mcap_record(4, struct.pack("<HH", i, 1) + text(topic) + text("cdr") + struct.pack("<I", 0))
                        for i, topic in enumerate(topics))
    body = mcap_record(1, text("ros2") + text("log_writers"))
    for begin in range(0, len(scans), per_chunk):
        inside = schema + channels if begin == 0 else b""
        part = scans[begin:begin + per_chunk]
        for s in part:
            for number in range(len(topics)):
                inside += mcap_record(5, struct.pack("<HIQQ", number, 0, s.stamp_ns, s.stamp_ns) +
                                      laser_scan_cdr(s, representation))
        small = packed(packing, inside)
        body += mcap_record(6, struct.pack("<QQQI", part[0].stamp_ns, part[-1].stamp_ns, len(inside),
                                           zlib.crc32(inside)) + text(packing) + struct.pack("<Q", len(small)) + small)
    magic = b"\x89MCAP0\r\n"
    end = mcap_record(15, struct.pack("<I", 0)) + mcap_record(2, struct.pack("<QQI", 0, 0, 0))
    path.write_bytes(magic + body + end + magic)


def write_db3(path, scans, topics=("/scan",), representation=1):
    path.unlink(missing_ok=True)
    with sqlite3.connect(path) as db:
        db.executescript("""
            CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
            CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                                serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                                  data BLOB NOT NULL);
            CREATE INDEX timestamp_idx ON messages (timestamp ASC);""")
        for number, topic in enumerate(topics, 1):
            db.execute("INSERT INTO topics VALUES (?, ?, 'sensor_msgs/msg/LaserScan', 'cdr', '')", (number, topic))
        for s in scans:
            for number in range(1, len(topics) + 1):
                db.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                           (number, s.stamp_ns, laser_scan_cdr(s, representation)))
    db.close()


# MRPT: objects, each with its class and version before and a mark behind it.


def mrpt_object(name, version, data, is_old=False):
    if is_old:  # before MRPT 0.5.5
        return struct.pack("<I", len(name)) + name.encode() + struct.pack("<i", version) + data
    return struct.pack("<B", 0x80 | len(name)) + name.encode() + struct.pack("<B", version) + data + b"\x88"


def mrpt_matrix(rows, columns, kind, is_old):
    values = struct.pack(f"<{rows * columns}{kind}", *[0.0] * (rows * columns))
    return mrpt_object("CMatrix" if kind == "f" else "CMatrixD", 0, struct.pack("<II", rows, columns) + values, is_old)


def mrpt_pose(version, is_old):
    if version < 2:
        return mrpt_object("CPose3D", version, mrpt_matrix(4, 4, "fd"[version], is_old), is_old)
    return mrpt_object("CPose3D", version, bytes(8 * (7 if version == 2 else 12)), is_old)


def mrpt_scan(s, version=7, label="LASER", pose=3, is_old=False):
    """As version `version` of CObservation2DRangeScan says it."""
    aperture = abs(s.step_rad) * (len(s.ranges_m) - 1)
    data = struct.pack("<fBf", aperture, s.step_rad > 0, s.range_max_m) + mrpt_pose(pose, is_old)
    data += mrpt_matrix(6, 6, "f", is_old) if version < 6 else b""
    data += struct.pack("<I", len(s.ranges_m)) + floats(s.ranges_m)
    data += bytes(r < s.range_max_m for r in s.ranges_m) if version >= 1 else b""
    data += struct.pack("<f", 0.01) if version >= 2 else b""
    data += struct.pack("<Q", s.stamp_ns // 100 + 116444736000000000) if version >= 3 else b""
    data += struct.pack("<f", 0.0) if version >= 4 else b""
    data += text(label) + struct.pack("<d", 0.0) if version >= 5 else b""
    data += b"\0" if version >= 7 else b""
    return mrpt_object("CObservation2DRangeScan", version, data, is_old)


def write_rawlog(path, scans, **options):
    with gzip.GzipFile(path, "wb", mtime=0) as out:
        for s in scans:
            out.write(mrpt_object("CObservationOdometry", 2, bytes(40)))
            out.write(mrpt_scan(s, **options))
