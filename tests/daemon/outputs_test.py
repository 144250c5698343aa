"""What the daemon saves is whole, belongs together, and is never lost by another run, a kill or a disk that fails; and while it
saves, everything else goes on.

    outputs_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES
"""

import hashlib
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import threading
import time

from support import PROGRAMS, SOURCES, DaemonCase, alone, main

EX_DATAERR, EX_CANTCREAT = 65, 73
FILES = {"trajectory.tum", "trajectory_online.tum", "map.pgm", "map.yaml", "map.png", "map.svg", "summary.json"}
KILLS = 10


def contents(folder):
    """The hash of each file, by its path in there."""
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            with open(os.path.join(place, name), "rb") as file:
                found[os.path.relpath(os.path.join(place, name), folder)] = hashlib.sha256(file.read()).hexdigest()
    return found


class OutputsTest(DaemonCase):
    def runs(self, out="out"):
        return sorted(entry.name for entry in os.scandir(self.path(out)) if entry.is_dir(follow_symlinks=False)
                      and not entry.name.startswith("."))

    def expect_whole(self, folder):
        """All files are there, and they are of one save."""
        self.assertEqual(set(os.listdir(folder)), FILES)
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        found = contents(folder)
        self.assertEqual(found["trajectory.tum"], summary["sha256"])
        for name in ("trajectory.tum", "trajectory_online.tum"):
            with open(os.path.join(folder, name), "rb") as file:
                self.assertEqual(file.read().count(b"\n"), summary["scans"], name)
        with open(os.path.join(folder, "map.pgm"), "rb") as file:
            data = file.read()
        width, height = map(int, data.split(b"\n")[1].split())
        self.assertEqual(len(data), len(f"P5\n{width} {height}\n255\n") + width * height)
        with open(os.path.join(folder, "map.png"), "rb") as file:
            self.assertIn(b"IEND", file.read()[-12:])

    def finish(self, daemon, status=0):
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=60), status)
        return daemon.stderr.read()

    def start_mapping(self, *more):
        daemon = self.start_daemon(*more)
        self.wait_until_ok()
        return daemon

    def accepted(self):
        return json.loads(self.answer("status json"))["scans"]["accepted"]

    # Runs

    def test_each_run_has_its_own_folder_and_latest_leads_to_the_last(self):
        self.start_laser()
        daemon = self.start_mapping()
        self.assertEqual(self.ctl("save").returncode, 0)
        first_save = self.runs()
        said = self.ctl("save").stdout
        self.assertEqual(len(self.runs()), 1, "a run has one folder")
        self.assertNotEqual(self.runs(), first_save)
        self.assertIn(self.runs()[0], said)
        self.finish(daemon)
        (first,) = self.runs()
        before = contents(self.path("out/" + first))
        self.finish(self.start_mapping())
        self.assertEqual(len(self.runs()), 2)
        self.assertEqual(contents(self.path("out/" + first)), before)
        self.assertEqual(os.readlink(self.path("out/latest")), max(self.runs(), key=lambda r: os.path.getmtime(self.path("out/" + r))))
        for each in self.runs():
            self.expect_whole(self.path("out/" + each))

    def test_saves_where_it_is_told_and_overwrites_nothing_unless_forced(self):
        self.start_laser()
        self.start("odolessd", "--config", self.config)
        self.wait_until_ok()
        refused = self.ctl("save")
        self.assertEqual(refused.returncode, EX_DATAERR)
        self.assertIn("--out", refused.stderr)
        done = subprocess.run([os.path.abspath(os.path.join(PROGRAMS, "odoless")), "ctl", "--socket", self.path("control"), "save",
                               "a folder/b"], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(self.path("a folder/b"), done.stdout)
        self.expect_whole(self.path("a folder/b"))
        before = contents(self.path("a folder"))
        refused = self.ctl("save", self.path("a folder/b"))
        self.assertEqual(refused.returncode, EX_CANTCREAT)
        self.assertIn("--force", refused.stderr)
        self.assertEqual(contents(self.path("a folder")), before)
        self.assertEqual(self.ctl("save", "--force", self.path("a folder/b")).returncode, 0)
        self.assertNotEqual(contents(self.path("a folder")), before)
        self.expect_whole(self.path("a folder/b"))

    # Kills

    def test_a_kill_at_any_moment_leaves_whole_results_alone(self):
        chance = random.Random(17)
        self.start_laser()
        for kill in range(KILLS):
            daemon = self.start_mapping()
            over = threading.Event()

            def save_again_and_again():
                while not over.is_set():
                    try:
                        self.answer("save")
                    except OSError:
                        return
                    time.sleep(0.05)

            saver = threading.Thread(target=save_again_and_again)
            saver.start()
            time.sleep(chance.uniform(0.0, 2.0))
            daemon.kill()
            daemon.wait()
            over.set()
            saver.join()
            for each in self.runs() if os.path.isdir(self.path("out")) else []:
                with self.subTest(kill=kill, run=each):
                    self.expect_whole(self.path("out/" + each))
        self.finish(self.start_mapping())
        hidden = [name for name in os.listdir(self.path("out")) if name.startswith(".unfinished")]
        self.assertEqual(hidden, [], "what killed daemons left is removed")
        self.assertGreater(len(self.runs()), 1)

    # Disks

    def mount(self, *arguments):
        done = subprocess.run(["mount", *arguments], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            self.skipTest(f"nothing can be mounted here: {done.stderr.strip()}")

    def expect_fails_and_goes_on(self, reason):
        """Saving fails for that reason, is told of at once, and mapping goes on."""
        before = self.accepted()
        failed = self.ctl("save")
        self.assertEqual(failed.returncode, EX_CANTCREAT, failed.stdout)
        self.assertIn(reason, failed.stderr)
        self.wait_until(lambda: "a file cannot be written" in self.state(), 1)
        self.assertIn("save: FAILED", self.ctl("status").stdout)
        self.wait_until(lambda: self.accepted() > before + 5, 5)

    def expect_recovers(self):
        self.wait_until(lambda: self.ctl("save").returncode == 0, 5)
        self.wait_until(lambda: "a file cannot be written" not in self.state(), 5)

    def test_a_full_disk_damages_nothing_and_is_told_until_there_is_room(self):
        os.mkdir(self.path("out"))
        self.mount("-t", "tmpfs", "-o", "size=4m", "tmpfs", self.path("out"))
        self.addCleanup(subprocess.run, ["umount", "-l", self.path("out")], check=False)
        self.start_laser()
        daemon = self.start_mapping()
        self.assertEqual(self.ctl("save").returncode, 0)
        (saved,) = self.runs()
        before = contents(self.path("out/" + saved))
        with open(self.path("out/filler"), "wb", buffering=0) as filler:
            try:
                while True:
                    filler.write(bytes(4096))
            except OSError:
                pass
        self.expect_fails_and_goes_on("No space left on device")
        self.assertEqual(contents(self.path("out/" + saved)), before)
        os.remove(self.path("out/filler"))
        self.expect_recovers()
        self.finish(daemon)
        (saved,) = self.runs()
        self.expect_whole(self.path("out/" + saved))

    def test_a_folder_that_becomes_read_only_is_told_until_it_can_be_written_to(self):
        self.start_laser()
        daemon = self.start_mapping()
        self.assertEqual(self.ctl("save").returncode, 0)
        before = contents(self.path("out"))
        self.mount("--bind", self.path("out"), self.path("out"))
        self.addCleanup(subprocess.run, ["umount", "-l", self.path("out")], capture_output=True, check=False)
        self.mount("-o", "remount,bind,ro", self.path("out"))
        self.expect_fails_and_goes_on("Read-only file system")
        self.assertEqual(contents(self.path("out")), before)
        subprocess.run(["umount", self.path("out")], check=True)
        self.expect_recovers()
        self.finish(daemon)

    def test_a_folder_that_is_removed_is_made_anew(self):
        self.start_laser()
        daemon = self.start_mapping()
        self.assertEqual(self.ctl("save").returncode, 0)
        shutil.rmtree(self.path("out"))
        self.assertEqual(self.ctl("save").returncode, 0)
        (saved,) = self.runs()
        self.expect_whole(self.path("out/" + saved))
        shutil.rmtree(self.path("out"))
        with open(self.path("out"), "w", encoding="ascii"):
            self.expect_fails_and_goes_on(self.path("out"))
        os.remove(self.path("out"))
        self.expect_recovers()
        self.finish(daemon)

    def start_on_faulty_disk(self):
        """A daemon whose disk does as `self.disk` says."""
        self.notified = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.notified.close)
        self.notified.bind(self.path("notify"))
        self.notified.setblocking(False)
        daemon = self.start_daemon(environment=self.faulty_disk() | {"NOTIFY_SOCKET": self.path("notify")})
        self.wait_until_ok()
        return daemon

    def test_a_broken_disk_damages_nothing_and_is_told_until_it_works(self):
        self.start_laser()
        daemon = self.start_on_faulty_disk()
        self.assertEqual(self.ctl("save").returncode, 0)
        (saved,) = self.runs()
        before = contents(self.path("out/" + saved))
        self.disk("broken")
        self.expect_fails_and_goes_on("Input/output error")
        self.assertEqual(contents(self.path("out/" + saved)), before)
        self.assertEqual(self.runs(), [saved])
        self.disk("sound")
        self.expect_recovers()
        self.disk("broken")
        self.assertIn("Input/output error", self.finish(daemon, EX_CANTCREAT))
        (saved,) = self.runs()
        self.expect_whole(self.path("out/" + saved))

    def notifications(self):
        """What the service manager was told since the last call."""
        told = []
        while True:
            try:
                told.append(self.notified.recv(4096).decode())
            except BlockingIOError:
                return told

    def longest_silence_s(self, holds):
        """Of the watchdog, and of the answers to status, as long as this holds."""
        silence_s = answer_s = 0.0
        fed = time.monotonic()
        while holds():
            begin = time.monotonic()
            try:
                self.answer("status")
            except OSError:
                break
            answer_s = max(answer_s, time.monotonic() - begin)
            if any("WATCHDOG=1" in told for told in self.notifications()):
                fed = time.monotonic()
            silence_s = max(silence_s, time.monotonic() - fed)
            time.sleep(0.02)
        return silence_s, answer_s

    @alone
    def test_a_slow_disk_holds_up_nobody(self):
        self.start_laser()
        daemon = self.start_on_faulty_disk()
        self.disk("slow")
        begin = time.monotonic()
        self.assertEqual(self.answer("save"), "ok: saving; status says when it is done\n")
        self.assertIn("a save is under way", self.answer("save"))
        self.assertIn("save: under way", self.answer("status"))
        silence_s, answer_s = self.longest_silence_s(lambda: "save: under way" in self.answer("status"))
        took_s = time.monotonic() - begin
        print(f"  a save of {took_s:.1f} s: the watchdog was fed every {silence_s:.2f} s, commands were answered in {answer_s:.2f} s")
        self.assertGreater(took_s, 2.0)
        self.assertLess(max(silence_s, answer_s), 1.0)
        self.notifications()
        begin = time.monotonic()
        daemon.send_signal(signal.SIGTERM)
        silence_s, answer_s = self.longest_silence_s(lambda: daemon.poll() is None)
        self.assertEqual(daemon.wait(timeout=60), 0)
        print(f"  an end of {time.monotonic() - begin:.1f} s: fed every {silence_s:.2f} s, answered in {answer_s:.2f} s")
        self.assertGreater(time.monotonic() - begin, 2.0)
        self.assertLess(silence_s, 2.0, "the stages' end included")
        (saved,) = self.runs()
        self.expect_whole(self.path("out/" + saved))


if __name__ == "__main__":
    main()
