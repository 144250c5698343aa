"""The daemon as a service under a real systemd, as it is installed: it starts without any right but real time, is killed
and started again when it hangs and goes on in its world file, reads its configuration anew, and saves when it is stopped."""

import json
import os
import subprocess
import time
import unittest

from support import PROGRAMS, SMALL_DAEMON, DaemonTest, program, run

SYSTEMD = "/lib/systemd/systemd"
UNITS = "/run/hil-units"
CONFIG = "/etc/odoless/robot.toml"
RESULTS = "/var/lib/odoless"
PORT = 10940
# What a whole system has besides, which would take minutes in here.
TARGETS = ("sysinit", "basic", "network", "shutdown", "multi-user")
DAEMON = f"""
[lrf]
device = "tcp://127.0.0.1:{PORT}"
cluster = 8
[world]
file = "{RESULTS}/world"
[slam.low]
particles = 10
{SMALL_DAEMON}
"""
# A slow machine takes longer to start; and no journal runs.
SLOW = """
[Service]
WatchdogSec=20
TimeoutStartSec=300
StandardOutput=append:/var/log/odolessd.log
StandardError=append:/var/log/odolessd.log
"""


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


@unittest.skipUnless(os.path.exists(SYSTEMD), "systemd is not installed")
class ServiceTest(DaemonTest):
    def setUp(self):
        super().setUp()
        installed = run("cmake", "--install", os.path.dirname(PROGRAMS), "--prefix", "/usr", timeout=120)
        self.assertEqual(installed.returncode, 0, installed.stderr)
        made = run("systemd-sysusers", "/usr/lib/sysusers.d/odoless.conf")
        self.assertEqual(made.returncode, 0, made.stderr)
        write(CONFIG, DAEMON)
        self.start_laser("--tcp", PORT)
        self.boot()

    def boot(self):
        """systemd as the first process of a system of its own: it takes for a container what unshare makes."""
        for target in TARGETS:
            write(f"{UNITS}/{target}.target", f"[Unit]\nDescription={target}\nDefaultDependencies=no\n")
        with open("/usr/lib/systemd/system/odolessd.service", encoding="utf-8") as unit:
            write(f"{UNITS}/odolessd.service", unit.read())
        write(f"{UNITS}/odolessd.service.d/slow.conf", SLOW)
        environment = {**os.environ, "container": "hil", "SYSTEMD_UNIT_PATH": UNITS, "SYSTEMD_LOG_TARGET": "kmsg"}
        with open(self.path("systemd.log"), "w", encoding="utf-8") as log:
            unshare = self.start("unshare", "--pid", "--mount", "--cgroup", "--fork", "--kill-child", "--mount-proc",
                                 "sh", "-c", f"cp -r {UNITS} /dev/shm/units && mount -t tmpfs tmpfs /run && "
                                 f"mv /dev/shm/units {UNITS} && exec {SYSTEMD} --system --unit=multi-user.target",
                                 env=environment, stdout=log, stderr=subprocess.STDOUT)
        children = f"/proc/{unshare.pid}/task/{unshare.pid}/children"
        self.wait_until(lambda: run("cat", children).stdout.strip(), 20)
        self.init = run("cat", children).stdout.split()[0]
        self.wait_for(lambda: self.systemctl("show", "--property=Version", status=None).returncode == 0, 60, "systemd")

    def inside(self, *command, timeout=300):
        return run("nsenter", "--target", self.init, "--pid", "--mount", "--cgroup", "--root", *command, timeout=timeout)

    def systemctl(self, *arguments, status=0):
        outcome = self.inside("systemctl", *arguments)
        if status is not None:
            self.assertEqual(outcome.returncode, status, f"{arguments}: {outcome.stderr}\n{self.said()}")
        return outcome

    def property(self, name):
        return self.systemctl("show", "--property=" + name, "--value", "odolessd").stdout.strip()

    def said(self):
        text = "\n".join(line for line in run("dmesg").stdout.splitlines()[-100:] if "systemd" in line) + "\n"
        for path in (self.path("systemd.log"), "/var/log/odolessd.log"):
            if os.path.exists(path):
                with open(path, encoding="utf-8", errors="replace") as file:
                    text += f"{path}:\n{file.read()[-4000:]}\n"
        return text

    def status(self):
        return self.inside("odoless", "ctl", "--socket", "/run/odoless/control", "status", "--json").stdout

    def status_json(self):
        try:
            return json.loads(self.status())
        except json.JSONDecodeError:
            return {}

    def wait_for(self, holds, seconds, what):
        try:
            return self.wait_until(holds, seconds, what)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.status()}\n{self.said()}") from None

    def process_status(self):
        text = self.inside("cat", f"/proc/{self.property('MainPID')}/status").stdout
        return dict(line.split(":\t", 1) for line in text.splitlines() if ":\t" in line)

    def test_lives_as_a_service(self):
        self.systemctl("start", "--no-block", "odolessd")
        self.wait_for(lambda: self.property("ActiveState") == "active", 240, "the start")
        self.wait_for(lambda: self.status_json().get("world", {}).get("keyframes", 0) > 0, 120, "a keyframe")
        self.has_no_right_but_real_time()
        self.reads_its_configuration_anew()
        self.is_killed_when_it_hangs_and_goes_on()
        self.saves_when_it_is_stopped_under_load()

    def has_no_right_but_real_time(self):
        status = self.process_status()
        self.assertNotEqual(status["Uid"].split()[0], "0")
        for kind in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb"):
            self.assertEqual(int(status[kind], 16), 0, kind)
        self.assertEqual(status["NoNewPrivs"], "1")
        self.assertEqual(status["Seccomp"], "2")
        self.assertGreater(int(status["VmLck"].split()[0]), 1000, "memory is locked")
        policies = self.inside("ps", "-L", "-o", "comm=,cls=,rtprio=", "-p", self.property("MainPID")).stdout
        self.assertRegex(policies, r"odo-sensor +FF +10\b")
        self.assertRegex(policies, r"odo-filter +FF +40\b")

    def reads_its_configuration_anew(self):
        before = self.property("MainPID")
        self.systemctl("reload", "odolessd")
        self.wait_for(lambda: "[health] is in force" in self.said(), 20, "the reload")
        self.assertEqual(self.property("MainPID"), before)

    def is_killed_when_it_hangs_and_goes_on(self):
        before = self.property("MainPID")
        begin = time.monotonic()
        self.inside("kill", "-STOP", before)
        self.wait_for(lambda: self.property("NRestarts") == "1", 60, "the restart")
        hung_s = time.monotonic() - begin
        self.wait_for(lambda: self.status_json().get("pose"), 240, "going on")
        print(f"  hung: killed and started again after {hung_s:.1f} s; it has a pose again after {time.monotonic() - begin:.1f} s")
        self.assertNotEqual(self.property("MainPID"), before)
        self.wait_for(lambda: self.status_json().get("world", {}).get("session", 0) >= 2, 60, "the second session")
        self.assertIn("the run before crashed", self.said(), "by SIGABRT")

    def saves_when_it_is_stopped_under_load(self):
        load = [self.start("sh", "-c", "while :; do :; done") for _ in range(2)]
        begin = time.monotonic()
        self.systemctl("stop", "odolessd")
        print(f"  stopped under load in {time.monotonic() - begin:.1f} s")
        for process in load:
            process.kill()
        self.assertEqual(self.property("Result"), "success", self.said())
        self.assertEqual(self.property("ExecMainStatus"), "0")
        summary = self.inside("cat", f"{RESULTS}/latest/summary.json").stdout
        self.assertGreater(json.loads(summary)["scans_accepted"], 0, summary)
        self.assertEqual(run(*program("odoless", "world", "check", f"{RESULTS}/world")).returncode, 0)


