"""The daemon in two halves that speak over LCM, and a daemon that a played log feeds.

    split_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES
"""

import collections
import concurrent.futures
import itertools
import json
import math
import os
import random
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

PROGRAMS, SOURCES = sys.argv[1:3]
WORLD = os.path.join(SOURCES, "tools", "worlds", "rooms.world")
GROUP = "239.255.76.67"
LASER = ("--lrf", "utm-30lx")
RATE = 2  # recorded seconds per second
EVERY = 2  # of the scans one is taken: a slow machine must keep up, or records are dropped, as they should be
GAP_S = (16.0, 19.0)  # no scans
CARRIED_S = (26.0, 32.0)  # cut out: at its begin the robot is at once where it was at its end
END_S = 45.0
LATE_S = 5.0  # of the log, in which a busy machine's pose graph is done with a correction
SHORT_END_S = 12.0
MOTION = struct.Struct(">q qqqd 3d3d9d 25d25d25d 3d2d iii")  # odoless.motion_t up to its flags
JOLTED = 16
TRAILER_BYTES = 52  # of an authentic message
SO_RCVBUFFORCE = 33  # of Linux; Python does not name it


def program(name, *arguments):
    return [os.path.join(PROGRAMS, name), *map(str, arguments)]


def url(port):
    return f"udpm://{GROUP}:{port}"


def poses(path):
    with open(path, encoding="utf-8") as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    return {row[0]: (float(row[1]), float(row[2])) for row in rows}


def thin_out(log):
    with open(log, encoding="utf-8") as lines:
        kept = [line for i, line in enumerate(lines) if line.startswith("#") or i % EVERY == 0]
    with open(log, "w", encoding="utf-8") as out:
        out.writelines(kept)


def interrupt(log, interrupted):
    """Writes the log with a gap of scans, and with the robot carried from one scan to the next."""
    with open(log, encoding="utf-8") as lines, open(interrupted, "w", encoding="utf-8") as out:
        for line in lines:
            fields = line.split(" ")
            stamp_s = float(fields[-1])
            if stamp_s > END_S or any(begin <= stamp_s < end for begin, end in (GAP_S, CARRIED_S)):
                continue
            if stamp_s >= CARRIED_S[1]:
                fields[-3] = fields[-1] = f"{stamp_s - CARRIED_S[1] + CARRIED_S[0]:.6f}"
            out.write(" ".join(fields).rstrip() + "\n")


def recorded(path, channel):
    """The messages of a channel in a log as lcm-logger writes it."""
    header = struct.Struct(">IQQII")
    with open(path, "rb") as file:
        while head := file.read(header.size):
            _, _, _, channel_size, size = header.unpack(head)
            name = file.read(channel_size).decode()
            message = file.read(size)
            if name == channel:
                yield message


def forged(datagrams):
    """What somebody on the network could make of the last motion: of a far time, a robot that leaps, a covariance that is
    none."""
    datagram = datagrams[-1]
    begin = 8 + len(datagram[8:].partition(b"\0")[0]) + 1 + 8  # of its stamp
    utime, reference_utime = struct.unpack_from(">qq", datagram, begin)
    for off_us in (10**13, 3_600_000_000, -3_600_000_000):
        yield datagram[:begin] + struct.pack(">qq", utime + off_us, reference_utime + off_us) + datagram[begin + 16:]
    yield datagram[:begin + 32] + struct.pack(">d", 5.0) + datagram[begin + 40:]  # previous_T_current's x_m
    noise = begin + 32 + 8 * (3 + 3 + 9 + 25 + 25)
    yield datagram[:noise] + struct.pack(">d", 1e5) + datagram[noise + 8:]


def attacked(datagrams):
    """What somebody without the key could make of the last of these authentic datagrams: a message without a trailer, an
    altered one, one of another channel, and those that he has heard, again."""
    last = datagrams[-1]
    yield last[:-TRAILER_BYTES]
    yield last[:len(last) // 2] + bytes([last[len(last) // 2] ^ 1]) + last[len(last) // 2 + 1:]
    yield last.replace(b"_MOTION\0", b"_MOTION_AGAIN\0", 1)
    yield last
    yield datagrams[0]


class Relay(threading.Thread):
    """Takes the datagrams of one port to another, but for some that it drops: which ones depends on no time, but on
    their channel, their stamp, and how often both came before. Adds motions: what `forges` makes of one, or of those
    of late, if it is there."""

    def __init__(self, from_port, to_port, dropped_share, forges):
        super().__init__(daemon=True)
        self.forger, self.forges = None, forges
        self.motions = collections.deque(maxlen=20)
        if forges:
            self.forger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.forger.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.to_port, self.dropped_share = to_port, dropped_share
        self.seen = collections.Counter()
        self.passed = self.dropped = 0
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 1 << 22)
        except PermissionError:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        self.socket.bind((GROUP, from_port))
        membership = struct.pack("4s4s", socket.inet_aton(GROUP), socket.inet_aton("0.0.0.0"))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

    def run(self):
        while True:
            datagram = self.socket.recv(1 << 16)
            channel, _, message = datagram[8:].partition(b"\0")
            name = channel + message[8:16]  # behind the type's fingerprint
            self.seen[name] += 1
            if random.Random(f"{name}{self.seen[name]}").random() < self.dropped_share:
                self.dropped += 1
            else:
                self.passed += 1
                self.socket.sendto(datagram, (GROUP, self.to_port))
                if self.forger is not None and channel.endswith(b"_MOTION"):
                    self.motions.append(datagram)
                    for other in self.forges(self.motions):
                        self.forger.sendto(other, (GROUP, self.to_port))


class Runs:
    """Replays at their pace, three at a time, for they mostly wait: each in whole, or in two halves."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = []
        self.ports = itertools.count(20000 + os.getpid() % 20000, 2)  # relays go on until the end
        self.pool = concurrent.futures.ThreadPoolExecutor(3)
        self.one_relay = threading.Lock()  # at a time: it forwards thousands of datagrams a second
        self.begun = {}
        self.log, self.interrupted = self.path("rooms.log"), self.path("interrupted.log")
        subprocess.run(program("odoless", "sim", WORLD, *LASER, "--out", self.log), check=True, stdout=subprocess.DEVNULL)
        thin_out(self.log)
        interrupt(self.log, self.interrupted)
        self.short, self.key = self.path("short.log"), self.path("key")
        with open(self.log, encoding="utf-8") as lines, open(self.short, "w", encoding="utf-8") as out:
            out.writelines(line for line in lines if float(line.split(" ")[-1]) <= SHORT_END_S)
        with open(self.key, "w", encoding="utf-8", opener=lambda path, flags: os.open(path, flags, 0o600)) as out:
            out.write(os.urandom(32).hex() + "\n")

    def begin(self, name, run, *arguments):
        self.begun[name] = self.pool.submit(run, name, *arguments)

    def of(self, name):
        """Waits until it is over. Returns its relay, if it has one."""
        return self.begun[name].result()

    def end(self):
        """Of all, also where a test has failed."""
        for run in self.begun.values():
            run.cancel()
        for process in self.processes:
            if process.poll() is None:
                process.kill()
        self.pool.shutdown()

    def path(self, name):
        return os.path.join(self.folder, name)

    def config(self, name, **tables):
        # No budget and no queue is to change what comes out: the machine may be slow.
        unbounded = {"matcher_budget_ms": 1000.0, "filter_budget_ms": 10_000.0, "scan_budget_ms": 20_000.0,
                     "particles_min": 10_000, "scan_queue": 1024, "motion_queue": 4096}
        tables = {"control": {"socket": ""}, "pipeline": unbounded} | tables
        with open(self.path(name + ".toml"), "w", encoding="utf-8") as file:
            for table, keys in tables.items():
                file.write(f"[{table}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items()))
        return self.path(name + ".toml")

    def daemon(self, name, config, *more):
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notified, \
             open(self.path(name + ".txt"), "w", encoding="utf-8") as log:  # as its service manager would
            notified.settimeout(60)
            notified.bind(self.path(name + ".notify"))
            process = subprocess.Popen(program("odolessd", "--config", config, "--out", self.path(name), *more), stderr=log,
                                       env=os.environ | {"NOTIFY_SOCKET": self.path(name + ".notify")})
            self.processes.append(process)
            while b"READY=1" not in notified.recv(4096):
                pass
        return process

    def finish_idle(self, name, process):
        """Ends it when no scans come and nothing waits in its queues: in half a second it uses less than a tenth of a core."""
        def has_paused():
            before_s = self.cpu_s(process)
            time.sleep(0.5)
            return self.cpu_s(process) - before_s < 0.05

        for holds in (lambda: self.says(name, "no scans"), has_paused):
            end = time.monotonic() + 60
            while not holds():
                assert time.monotonic() < end, f"{name}: did not happen in time"
                time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        self.finish(name, process)

    @staticmethod
    def cpu_s(process):
        with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def says(self, name, what):
        with open(self.path(name + ".txt"), encoding="utf-8") as log:
            return what in log.read()

    def finish(self, name, process):
        status = process.wait(timeout=90)
        with open(self.path(name + ".txt"), encoding="utf-8") as log:
            assert status == 0, f"{name} ended with {status}: {log.read()}"

    def summary(self, name):
        with open(self.path(name + "/latest/summary.json"), encoding="utf-8") as file:
            return json.load(file)

    def whole(self, name, log, graph=True):
        """A log at its pace through one process."""
        config = self.config(name, lcm={"url": ""}, recorder={"path": self.path(name + "_recorded")}, graph={"enabled": graph})
        self.finish(name, self.daemon(name, config, "--replay", log, "--rate", RATE))

    def split(self, name, log, dropped_share=0.0, forges=None, graph=True, key=""):
        """The same through two processes, with a relay between them if some are to be dropped."""
        from_port = to_port = next(self.ports)
        if dropped_share == 0.0 and forges is None:
            self.halves(name, log, (from_port, to_port), graph, key)
            return None
        with self.one_relay:
            to_port = from_port + 1
            relay = Relay(from_port, to_port, dropped_share, forges)
            relay.start()
            self.halves(name, log, (from_port, to_port), graph, key)
            return relay

    def halves(self, name, log, ports, graph, key):
        from_port, to_port = ports
        after = self.daemon(name, self.config(name, lcm={"url": url(to_port), "key_file": key}, graph={"enabled": graph}),
                            "--stages", "filter")
        before = self.daemon(name + "_front", self.config(name + "_front", lcm={"url": url(from_port), "key_file": key}),
                             "--stages", "sensor,matcher", "--replay", log, "--rate", RATE)
        self.finish(name + "_front", before)
        self.finish_idle(name, after)

    def played(self, name, player, recorded_by):
        """What another has recorded of its scans, to a daemon that has no laser of its own."""
        self.of(recorded_by)
        lcm_url = url(next(self.ports))
        daemon = self.daemon(name, self.config(name, lcm={"url": lcm_url}, lrf={"driver": "lcm", "channel": "ODOLESS_SCAN"}))
        subprocess.run([player, "--lcm-url=" + lcm_url + "?ttl=0", "--regexp=ODOLESS_SCAN",
                        self.path(recorded_by + "_recorded.00000.lcm")], check=True, timeout=120, stdout=subprocess.DEVNULL)
        self.finish_idle(name, daemon)


class SplitTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.runs = runs = Runs(folder.name)
        cls.addClassCleanup(runs.end)
        cls.path, cls.says, cls.summary = runs.path, runs.says, runs.summary
        cls.player = shutil.which("lcm-logplayer")
        # In this order each three are about as long, and one of them has a relay.
        runs.begin("lossy", runs.split, runs.log, 0.05)
        runs.begin("whole", runs.whole, runs.log)
        runs.begin("undivided", runs.whole, runs.interrupted)
        runs.begin("forged", runs.split, runs.log, 0.0, forged)
        runs.begin("lossless", runs.split, runs.interrupted)
        runs.begin("filter_whole", runs.whole, runs.interrupted, False)
        runs.begin("attacked", runs.split, runs.short, 0.0, attacked, True, runs.key)
        runs.begin("filter_split", runs.split, runs.interrupted, 0.0, None, False)
        if cls.player is not None:
            runs.begin("played", runs.played, cls.player, "undivided")

    def assert_same(self, run, other, names):
        for name in names:
            with open(self.path(f"{run}/latest/{name}"), "rb") as one, open(self.path(f"{other}/latest/{name}"), "rb") as two:
                self.assertEqual(one.read(), two.read(), name)

    def online(self, name):
        self.runs.of(name)
        return poses(self.path(name + "/latest/trajectory_online.tum"))

    def test_two_halves_are_the_whole_through_a_gap_and_a_jolt_when_nothing_is_lost(self):
        self.runs.of("undivided")
        motions = [MOTION.unpack(message[:MOTION.size])
                   for message in recorded(self.path("undivided_recorded.00000.lcm"), "ODOLESS_MOTION")]
        self.assertEqual(sum(duration_ns > 1e9 for _, _, _, duration_ns, *_ in motions), 1, "the log has a gap")
        self.assertGreater(sum(motion[-1] & JOLTED != 0 for motion in motions), 0, "and a jolt")
        self.runs.of("lossless")
        self.assertEqual(self.summary("lossless")["datagrams_lost"], 0)
        for name in ("undivided", "lossless"):
            self.assertTrue(self.says(name, "LOST"), name)
        self.assert_same("undivided", "lossless", ("trajectory.tum", "map.pgm"))
        one, two = self.online("undivided"), self.online("lossless")
        self.assertGreater(len(one), 300)
        self.assertEqual(one.keys(), two.keys())
        self.assert_apart_by_late_corrections_alone(one, two)

    def assert_apart_by_late_corrections_alone(self, one, two):
        """When a correction of the pose graph goes in depends on its thread's time, and what it is does not: the robot's steps are the
        same but for the few in which one goes in here and then there."""
        stamps = sorted(one, key=float)
        off = [(two[stamp][0] - one[stamp][0], two[stamp][1] - one[stamp][1]) for stamp in stamps]
        others = [i for i in range(1, len(off)) if math.dist(off[i - 1], off[i]) > 0.002]
        late_s = [float(stamps[end]) - float(stamps[begin]) for begin, end in zip(others, others[1:]) if math.hypot(*off[begin]) > 0.002]
        print(f"corrections go in at another time in {len(others)} of {len(stamps)} steps, at most {max(late_s, default=0.0):.2f} s later", file=sys.stderr)
        self.assertLessEqual(len(others), 20, "twice for each of some ten submaps")
        self.assertLess(math.hypot(*off[0]), 0.002)
        self.assertLess(math.hypot(*off[-1]), 0.002, "in the end all of them are in")
        self.assertLess(max(late_s, default=0.0), LATE_S)

    def test_two_halves_have_every_pose_of_the_filter_at_the_time(self):
        for name in ("filter_whole", "filter_split"):
            self.runs.of(name)
            self.assertTrue(self.says(name, "LOST"), name)
        self.assert_same("filter_whole", "filter_split", ("trajectory.tum", "trajectory_online.tum", "map.pgm"))

    def test_lost_datagrams_cost_little(self):
        whole, lossy = self.online("whole"), self.online("lossy")
        relay = self.runs.of("lossy")
        self.assertGreater(relay.dropped, 20)
        self.assertGreater(self.summary("lossy")["datagrams_lost"], 10)
        self.assertGreater(len(lossy), 0.98 * len(whole))  # the rest came when it was sent again
        off_m = max(math.dist(lossy[stamp], whole[stamp]) for stamp in lossy)
        answer = subprocess.run(program("odoless", "eval", "ate", self.path("whole/latest/trajectory_online.tum"),
                                        self.path("lossy/latest/trajectory_online.tum"), "--json"),
                                check=True, capture_output=True, text=True)
        aligned_m = json.loads(answer.stdout)["translation_m"]
        print(f"{relay.dropped} of {relay.dropped + relay.passed} datagrams lost: at most {off_m:.3f} m off; in one frame rmse "
              f"{aligned_m['rmse']:.3f} m, at most {aligned_m['max']:.3f} m; {len(whole) - len(lossy)} of {len(whole)} poses missing", file=sys.stderr)
        self.assertLess(off_m, 0.05)
        self.assertLess(aligned_m["rmse"], 0.02)

    def test_forged_motions_are_refused_and_said(self):
        whole, forged_at = self.online("whole"), self.online("forged")
        self.assertGreater(self.summary("forged")["motions_refused"], 4 * len(whole))
        self.assertIn("motions received over LCM are refused", self.summary("forged")["latched_reasons"])
        self.assertGreater(len(forged_at), 0.98 * len(whole))
        self.assertLess(max(math.dist(forged_at[stamp], whole[stamp]) for stamp in forged_at), 0.05)

    def test_with_a_key_nothing_is_taken_from_who_has_none(self):
        whole, attacked_at = self.online("whole"), self.online("attacked")
        summary = self.summary("attacked")
        motions = summary["scans"] - 1
        self.assertGreater(motions, 100)
        self.assertGreaterEqual(summary["messages_forged"], 3 * motions)
        self.assertGreaterEqual(summary["messages_replayed"], 2 * motions)
        self.assertEqual(summary["motions_refused"], 0, "none of them was looked at")
        self.assertIn("lcm.key_file", summary["latched_reasons"])
        self.assertGreaterEqual(len(attacked_at), motions)
        self.assertLess(max(math.dist(attacked_at[stamp], whole[stamp]) for stamp in attacked_at), 0.05)

    def test_a_played_log_drives_the_daemon_to_the_same_map(self):
        if self.player is None:
            self.skipTest("lcm-logplayer is missing (Debian's liblcm-bin)")
        self.runs.of("undivided")
        self.runs.of("played")
        self.assert_same("undivided", "played", ("trajectory.tum", "map.pgm"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
