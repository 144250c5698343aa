"""A live sample of the fault campaign: the daemon itself, an emulated laser with a fault, and the truth beside what the daemon says.

    campaign_test.py FOLDER_OF_PROGRAMS ROOT_OF_SOURCES

The times of the faults come from a random seed; tools/campaign has many more runs, without sockets.
"""

import bisect
import random
import signal
import threading
import time
import unittest

from support import DaemonCase, poses
from truth import Truth, relative

WRONG_M, WRONG_DEG, SILENT_S = 0.5, 5.0, 1.0
OLD_S = 0.5  # an older pose says nothing of its own time
PERIOD_S = 0.1


class Says:
    """What the daemon answers, 10 times a second, and when."""

    def __init__(self, ask):
        self.ask, self.said, self.ends = ask, [], threading.Event()
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        while not self.ends.wait(PERIOD_S):
            try:
                begin_s = time.time()
                answer = self.ask("status")
            except OSError:
                continue
            if time.time() - begin_s < PERIOD_S:  # else nobody knows of when it is
                self.said.append((time.time(), answer.split(":")[0].split("\n")[0].strip()))

    def end(self):
        self.ends.set()
        self.thread.join()
        return self.said


class CampaignTest(DaemonCase):
    LASTS_S = 12.0

    def longest_silent_s(self, said):
        """How long it said OK at a stretch while its last pose was wrong."""
        truth, online = Truth(self.path("truth.tum")), poses(self.path("out/latest/trajectory_online.tum"))
        stamps_us = sorted(online)
        longest_s, since_s, right = 0.0, None, 0
        for time_s, state in said:
            last = bisect.bisect(stamps_us, round(time_s * 1e6)) - 1
            if last < 0:
                continue
            stamp_us = stamps_us[last]
            is_old = time_s - stamp_us * 1e-6 > OLD_S
            off_m, off_deg = truth.off(stamps_us[0], round(time_s * 1e6) if is_old else stamp_us,
                                       relative(online[stamps_us[0]], online[stamp_us]))
            wrong = off_m > WRONG_M or off_deg > WRONG_DEG
            right += not wrong
            since_s = (since_s or time_s) if wrong and state == "OK" else None
            longest_s = max(longest_s, time_s - since_s) if since_s else longest_s
        self.assertGreater(right, 20, "the truth and the poses do not belong together")
        return longest_s

    def watch(self, *fault, meanwhile=lambda daemon: None):
        self.start_laser("--truth", self.path("truth.tum"), "--start-delay-s", 1, *fault)
        daemon = self.start_daemon()
        self.wait_until_ok()
        says = Says(self.answer)
        meanwhile(daemon)
        time.sleep(max(0.0, self.LASTS_S - PERIOD_S * len(says.said)))
        said = says.end()
        self.stop_in_time(daemon)
        silent_s = self.longest_silent_s(said)
        print(f"  {' '.join(map(str, fault)) or 'the daemon stopped'}: OK and wrong for {silent_s:.1f} s at a stretch")
        self.assertLess(silent_s, SILENT_S)

    def test_is_never_sure_of_a_wrong_pose_after_a_silence(self):
        chance = random.Random(1)
        self.watch("--fault", f"silence@{chance.uniform(3.0, 4.5):.1f}:{chance.uniform(2.0, 5.0):.1f}")

    def test_is_never_sure_of_a_wrong_pose_after_garbage(self):
        chance = random.Random(2)
        self.watch("--fault", f"garbage@{chance.uniform(3.0, 4.5):.1f}:{chance.uniform(2.0, 5.0):.1f}")

    def test_is_never_sure_of_a_wrong_pose_after_it_stood_still(self):
        def stop_and_go(daemon):
            time.sleep(4.5)
            daemon.send_signal(signal.SIGSTOP)
            time.sleep(3.0)
            daemon.send_signal(signal.SIGCONT)

        self.watch(meanwhile=stop_and_go)


if __name__ == "__main__":
    unittest.main(argv=["campaign_test"], verbosity=2)
