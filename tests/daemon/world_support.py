"""What tests of worlds share: logs, replays and daemons with a world file."""

import contextlib
import json
import sqlite3

from support import DaemonCase, run


def content(path):
    with open(path, "rb") as file:
        return file.read()


class WorldCase(DaemonCase):
    def world(self, *command, status=0):
        outcome = run("odoless", "world", *command)
        self.assertEqual(outcome.returncode, status, outcome.stderr)
        return outcome

    def log(self):
        log = self.path("rooms.log")
        self.assertEqual(run("odoless", "sim", self.laser_world, "--out", log).returncode, 0)
        return log

    def ask(self, query):
        """The first value that the file gives now, as any reader of SQLite sees it."""
        with contextlib.closing(sqlite3.connect(f"file:{self.path('w')}?mode=ro", uri=True)) as database:
            return database.execute(query).fetchone()[0]

    def count(self, table):
        return self.ask(f"SELECT count(*) FROM {table}")

    def count_in_time(self, table):
        try:
            return self.count(table)
        except sqlite3.OperationalError:  # not yet made
            return 0

    def start_world(self, environment=None):
        self.start_laser()
        daemon = self.start_daemon("--world", self.path("w"), environment=environment)
        self.wait_until(lambda: self.count_in_time("keyframe") > 1, 20)
        return daemon

    def status_json(self):
        return json.loads(self.answer("status json"))

    def world_json(self):
        return json.loads(self.answer("world json"))

    def go_over(self, command):
        """`localise` or `map`, which answers when it is done."""
        outcome = self.ctl(command)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        return outcome.stdout

    def poses(self, path):
        with open(self.path(path), encoding="utf-8") as file:
            rows = [[float(value) for value in line.split()] for line in file if not line.startswith("#")]
        return {row[0]: row[1:3] for row in rows}

    def part_of(self, log, begin, end):
        """The scans of a log from one share of it to another."""
        with open(log, encoding="utf-8") as file:
            lines = file.readlines()
        scans = [index for index, line in enumerate(lines) if line.startswith("FLASER")] + [len(lines)]
        first, last = (scans[int(share * (len(scans) - 1))] for share in (begin, end))
        part = self.path(f"part_{begin}_{end}.log")
        with open(part, "w", encoding="utf-8") as file:
            file.writelines(lines[first:last])
        return part

    def replay_into(self, world, log, out, *options):
        made = run("odoless", "replay", log, "--out", self.path(out), "--world", self.path(world), *options)
        self.assertEqual(made.returncode, 0, made.stderr)
