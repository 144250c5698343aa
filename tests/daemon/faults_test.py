"""What the daemon's surroundings can do to it: commands, sockets, limits, signals, folders, a stage that hangs.

    faults_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES
"""

import ctypes
import json
import os
import resource
import signal
import socket
import subprocess
import threading
import time

from support import WORLD, DaemonCase, alone, main, program, run
from fault_matrix import measured  # found by support
from host_watch import keep_promise

EX_USAGE, EX_DATAERR, EX_UNAVAILABLE, EX_SOFTWARE, EX_OSERR, EX_CANTCREAT = 64, 65, 69, 70, 71, 73
EX_NOPERM, EX_CONFIG = 77, 78
PR_CAPBSET_DROP, CAP_SYS_NICE = 24, 23
PTRACE_DETACH, PTRACE_SEIZE, PTRACE_INTERRUPT, WALL = 17, 0x4206, 0x4207, 0x40000000
AS, NOFILE, FSIZE, NPROC = resource.RLIMIT_AS, resource.RLIMIT_NOFILE, resource.RLIMIT_FSIZE, resource.RLIMIT_NPROC
NOBODY = 65534


def limited(*limits):
    """For a process that is to begin with these limits: pairs of a resource and a number."""
    def set_limits():
        for kind, number in limits:
            resource.setrlimit(kind, (number, number))
    return set_limits


def without_real_time():
    """For a process that is to begin without the right to it, also as root."""
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0)
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))


class FaultsTest(DaemonCase):
    def start_limited(self, set_limits, *more):
        process = subprocess.Popen(program("odolessd", "--config", self.config, *more), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, preexec_fn=set_limits)
        self.addCleanup(self.end, process)
        self.processes.append(process)
        return process

    def start_without_laser(self, *more):
        daemon = self.start_daemon(*more)
        self.wait_until(lambda: self.state().startswith(("INIT", "FAULT")), 10)
        return daemon

    def expect_saved(self, daemon, status=0):
        """Returns what the daemon has said."""
        ended_with, said = daemon.wait(timeout=20), daemon.stderr.read()
        self.assertEqual(ended_with, status, said)
        self.assertTrue(os.path.getsize(self.path("out/latest/summary.json")) > 0)
        return said

    # Commands

    def test_refuses_a_pose_that_cannot_be_and_lives(self):
        daemon = self.start_without_laser()
        for pose in (("0", "0", "1e308"), ("1e308", "0", "0"), ("nan", "0", "0"), ("0", "0", "361"), ("1", "2", "3", "4")):
            outcome = self.ctl("--", "pose", *pose)
            self.assertEqual(outcome.returncode, EX_DATAERR, pose)
            self.assertIn("pose", outcome.stderr)
        self.assertEqual(self.ctl("--", "pose", "-10000", "10000", "-360").stdout, "ok\n")
        time.sleep(0.2)
        self.assertTrue(self.state())
        daemon.send_signal(signal.SIGTERM)
        said = self.expect_saved(daemon)
        self.assertIn(f"command 'pose -10000 10000 -360' of user {os.getuid()}, pid ", said)
        self.assertNotIn("status", said, "a question changes nothing")

    @alone
    def test_a_client_that_sends_a_byte_now_and_then_holds_nobody_up(self):
        def drip():
            with socket.socket(socket.AF_UNIX) as client:
                client.connect(self.path("control"))
                try:
                    while not over.wait(0.08):
                        client.sendall(b"x")
                except OSError:
                    pass  # its time is over

        over = threading.Event()
        self.addCleanup(over.set)
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as service_manager:
            service_manager.bind(self.path("notify"))
            service_manager.settimeout(5)
            os.environ["NOTIFY_SOCKET"] = self.path("notify")
            self.addCleanup(os.environ.pop, "NOTIFY_SOCKET")
            daemon = self.start_without_laser()
            drippers = [threading.Thread(target=drip, daemon=True) for _ in range(5)]
            for dripper in drippers:
                dripper.start()
            time.sleep(0.2)
            keep_promise(self, 0.5, self.answer_s)
            begin = time.monotonic()
            while b"WATCHDOG=1" not in service_manager.recv(4096) or time.monotonic() - begin < 0.5:
                self.assertLess(time.monotonic() - begin, 5)
            self.stop_in_time(daemon)

    # Sockets

    def test_refuses_a_path_for_its_socket_that_is_a_file_and_leaves_it_alone(self):
        with open(self.path("control"), "w", encoding="ascii") as file:
            file.write("precious")
        outcome = run("odolessd", "--config", self.config, timeout=10)
        self.assertEqual(outcome.returncode, EX_CANTCREAT, outcome.stderr)
        self.assertIn("control.socket", outcome.stderr)
        with open(self.path("control"), encoding="ascii") as file:
            self.assertEqual(file.read(), "precious")

    def test_refuses_the_socket_of_another_daemon_and_says_whose_it_is(self):
        first = self.start_without_laser()
        second = run("odolessd", "--config", self.config, timeout=10)
        self.assertEqual(second.returncode, EX_UNAVAILABLE, second.stderr)
        self.assertIn(f"pid {first.pid}", second.stderr)
        self.assertIn(self.path("control"), second.stderr)
        self.assertEqual(self.ctl("status").returncode, 0)

    # What a start lacks

    def expect_refused(self, daemon, status, *words):
        self.assertEqual(daemon.wait(timeout=10), status)
        said = daemon.stderr.read()
        for word in words:
            self.assertIn(word, said)
        without_right = "memory cannot be locked"  # said before, where it is so
        self.assertEqual(sum(without_right not in line for line in said.splitlines()), 1, said)
        self.assertFalse(os.path.exists(self.path("control")), "it has claimed its socket")

    def test_says_that_memory_does_not_suffice(self):
        for limit_bytes in (100 << 20, 150 << 20):  # for the pools; for threads and for saving
            with self.subTest(limit_bytes):
                self.expect_refused(self.start_limited(limited((AS, limit_bytes))), EX_OSERR, "memory", "ulimit -v")

    def test_says_that_descriptors_do_not_suffice(self):
        for number in (5, 9, 10, 40):
            with self.subTest(number):
                self.expect_refused(self.start_limited(limited((NOFILE, number))), EX_OSERR, "files", "ulimit -n")

    def test_says_that_threads_do_not_suffice(self):
        def as_somebody_without_threads():
            resource.setrlimit(NPROC, (1, 1))
            if os.getuid() == 0:  # whom the limit does not hold
                os.setuid(NOBODY)

        os.chmod(self.folder, 0o755)
        if os.getuid() == 0 and subprocess.run([program("odolessd")[0], "--version"], check=False, user=NOBODY,
                                               stdout=subprocess.DEVNULL).returncode != 0:
            self.skipTest("the programs are not for everybody to run")
        daemon = self.start_limited(as_somebody_without_threads)
        self.assertEqual(daemon.wait(timeout=10), EX_OSERR)
        self.assertIn("threads can be made", daemon.stderr.read())

    def test_is_not_ok_where_real_time_is_refused(self):
        self.start_laser()
        self.start_limited(without_real_time)
        self.wait_until(lambda: self.state() == "DEGRADED: real-time scheduling or locked memory is refused", 20)

    def test_ends_where_real_time_is_required_and_refused(self):
        self.start_laser()
        daemon = self.start_limited(without_real_time, "--require-realtime")
        self.expect_refused(daemon, EX_NOPERM, "real-time scheduling is refused", "--require-realtime")

    def test_ends_where_real_time_is_required_and_a_stage_has_no_priority(self):
        zeros = "".join(f"{stage}_priority = 0\n" for stage in ("sensor", "matcher", "filter"))
        for pipeline, stage in ((zeros, "sensor"), ("filter_priority = 0\n", "filter")):
            self.config = self.write_config("ordinary.toml", f"[pipeline]\n{pipeline}")
            for more in ((), ("--check",)):
                daemon = self.start_limited(None, "--require-realtime", *more)
                self.expect_refused(daemon, EX_CONFIG, f"pipeline.{stage}_priority is 0", "--require-realtime")
        self.config = self.write_config("half.toml", "[pipeline]\nfilter_priority = 0\n")
        outcome = run("odolessd", "--config", self.config, "--check", "--require-realtime", "--stages", "sensor,matcher")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)

    def test_says_that_a_folder_cannot_be_written_to(self):
        self.expect_refused(self.start_limited(None, "--out", "/proc/self"), EX_CANTCREAT, "/proc/self", "--out")
        self.config = self.write_config("missing.toml", f'[recorder]\npath = "{self.path("missing/run")}"\n')
        self.expect_refused(self.start_limited(None), EX_CANTCREAT, self.path("missing"), "recorder.path")

    def test_refuses_an_empty_value_on_its_command_line(self):
        for option in ("--config", "--out", "--replay"):
            outcome = run("odolessd", option, "", timeout=10)
            self.assertEqual(outcome.returncode, EX_USAGE, option)
            self.assertIn(option, outcome.stderr)

    # Ends

    def test_saves_whatever_signal_ends_it(self):
        for number in (signal.SIGUSR1, signal.SIGALRM, signal.SIGXFSZ, signal.SIGXCPU, signal.SIGQUIT, signal.SIGRTMIN + 3):
            with self.subTest(number):
                daemon = self.start_without_laser()
                daemon.send_signal(number)
                self.expect_saved(daemon)
                os.remove(self.path("out/latest/summary.json"))

    def test_a_file_that_may_not_grow_ends_nothing(self):
        self.config = self.write_config("recording.toml", f'[recorder]\npath = "{self.path("run")}"\n')
        self.start_laser()
        daemon = self.start_limited(limited((FSIZE, 0)), "--out", self.path("out"))
        self.wait_until(lambda: "a file cannot be written" in self.state(), 20)
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=10), EX_CANTCREAT)
        self.assertIn(self.path("out"), daemon.stderr.read(), "which file it was")

    def test_saves_a_replay_that_is_ended_with_much_to_do(self):
        log = self.path("rooms.log")
        self.assertEqual(run("odoless", "sim", WORLD, "--lrf", "utm-30lx", "--out", log).returncode, 0)
        self.config = self.write_config("slow.toml", "[pipeline]\nscan_queue = 1024\nmotion_queue = 4096\n"
                                                     "[slam.low]\nparticles = 1000\nspread_error = 0.0\n")
        daemon = self.start_daemon("--replay", log)
        self.wait_until(lambda: self.state() and json.loads(self.answer("status json"))["scans"]["accepted"] > 500, 30)
        daemon.send_signal(signal.SIGTERM)  # they wait in the queue: the filter takes 18 ms for each
        self.assertIn("left out", self.expect_saved(daemon))
        self.assertTrue(os.path.getsize(self.path("out/latest/map.pgm")) > 0)

    @alone
    def test_saves_what_is_known_when_a_stage_hangs(self):
        self.start_laser()
        for stage, signal_number in (("odo-matcher", None), ("odo-filter", signal.SIGTERM)):
            with self.subTest(stage):
                begin = time.monotonic()
                daemon = self.start_daemon()
                self.wait_until_ok()
                measured(35, "recover", time.monotonic() - begin, "s")
                time.sleep(1)
                held = self.hold_thread(daemon.pid, stage)
                begin = time.monotonic()
                if signal_number is None:
                    self.assertTrue(any("does not answer" in line for line in daemon.stderr))
                    measured(35, "flag", time.monotonic() - begin, "s")
                else:
                    daemon.send_signal(signal_number)
                self.reap_thread(held)
                said = self.expect_saved(daemon, EX_SOFTWARE)
                self.assertTrue(signal_number is None or "does not end" in said, said)
                self.assertTrue(os.path.getsize(self.path("out/latest/map.pgm")) > 0)
                self.assertTrue(os.path.getsize(self.path("out/latest/trajectory.tum")) > 0)
                os.remove(self.path("out/latest/map.pgm"))

    def test_time_in_which_a_machine_stands_still_is_not_time_in_which_a_stage_does_not_end(self):
        self.start_laser()
        daemon = self.start_daemon()
        self.wait_until_ok()
        held = self.hold_thread(daemon.pid, "odo-filter")
        daemon.send_signal(signal.SIGTERM)
        time.sleep(1)  # of the 2 s that a stage has
        daemon.send_signal(signal.SIGSTOP)
        time.sleep(3)
        daemon.send_signal(signal.SIGCONT)
        time.sleep(0.3)
        self.let_thread_go(held)
        self.expect_saved(daemon)

    def test_a_crash_leaves_a_report_and_the_next_start_says_where(self):
        self.start_laser()
        for number in (signal.SIGSEGV, signal.SIGABRT):
            with self.subTest(number):
                daemon = self.start_daemon("--world", self.path("w"), "--enforce-realtime")
                self.wait_until_ok()
                time.sleep(0.5)  # until the supervisor has seen that
                daemon.send_signal(number)
                self.assertEqual(daemon.wait(timeout=10), -number)
                self.assertIn(f"crashed by {number.name}; a report is in {self.path('out/.crash')}\n", daemon.stderr.read())
                daemon = self.start_daemon("--world", self.path("w"), "--enforce-realtime")
                self.wait_until_ok()
                daemon.send_signal(signal.SIGTERM)
                report = self.expect_saved(daemon).split("the run before crashed: ")[1].split(" has the report")[0]
                with open(report, encoding="utf-8") as file:
                    said = file.read()
                for words in (f"crashed by {number.name} that was sent", ", build ", "last log lines:\n", "streaming"):
                    self.assertIn(words, said)
                self.assertRegex(said, r"\nstate: (OK|DEGRADED)")
                self.assertFalse(os.path.exists(self.path("out/.crash")))
        self.assertEqual(run("odoless", "world", "check", self.path("w")).returncode, 0, "what was mapped is kept")

    def hold_thread(self, pid, name):
        """One thread of a process stands still, as in a call that never returns."""
        for thread in map(int, os.listdir(f"/proc/{pid}/task")):
            with open(f"/proc/{pid}/task/{thread}/comm", encoding="ascii") as comm:
                if comm.read().strip() == name:
                    if self.trace(PTRACE_SEIZE, thread) != 0:
                        self.skipTest("no thread may be traced here")
                    self.assertEqual(self.trace(PTRACE_INTERRUPT, thread), 0)
                    return thread
        self.fail(f"there is no thread {name}")

    def let_thread_go(self, thread):
        self.assertEqual(os.waitpid(thread, WALL)[0], thread)  # it stands still
        self.assertEqual(self.trace(PTRACE_DETACH, thread), 0, "its process has ended")

    @staticmethod
    def trace(request, thread):
        libc = ctypes.CDLL(None, use_errno=True)
        libc.ptrace.argtypes = (ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p)
        return libc.ptrace(request, thread, None, None)

    def reap_thread(self, thread):
        """Until its process has ended, which it cannot before who holds it has seen that."""
        end = time.monotonic() + 20
        while time.monotonic() < end:
            pid, status = os.waitpid(thread, WALL | os.WNOHANG)
            if pid == thread and (os.WIFEXITED(status) or os.WIFSIGNALED(status)):
                return
            time.sleep(0.01)
        self.fail("the daemon does not end")


if __name__ == "__main__":
    main()
