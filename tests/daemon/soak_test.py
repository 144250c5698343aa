"""tools/soak blames the machine only for what it withheld, and only where that accounts for all that broke."""

import importlib.machinery
import importlib.util
import json
import os
import sys
import tempfile
import time
import types
import unittest

LATE = "sensor: deadlines missed"


def load(path):
    loader = importlib.machinery.SourceFileLoader("soak", path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class WitnessTest(unittest.TestCase):
    HELD_S = 0.5

    def setUp(self):
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        except PermissionError:
            self.skipTest("no right to real-time priorities (root, or rtprio in limits.conf)")

    def seen_s(self, priority):
        """What is withheld of one processor, as the witness sees it, while this process keeps it busy."""
        everywhere = os.sched_getaffinity(0)
        with soak.Witness() as witness:
            time.sleep(0.1)  # until it watches
            os.sched_setaffinity(0, {min(everywhere)})
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
            try:
                begin = time.monotonic()
                while time.monotonic() < begin + self.HELD_S:
                    pass
            finally:
                os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
                os.sched_setaffinity(0, everywhere)
            end = time.monotonic()
        return witness.longest_s(begin, end)

    def test_nothing_of_a_lower_priority_holds_it_up(self):
        self.assertLess(self.seen_s(98), 0.5 * self.HELD_S)

    def test_it_sees_a_processor_that_it_does_not_get(self):
        self.assertGreater(self.seen_s(99), 0.9 * self.HELD_S)


class BlameTest(unittest.TestCase):
    """In a round with a budget of 25 ms, one processor was withheld for 15 ms, another one for 5 ms."""

    def blames_the_machine(self, broken, misses=1, cpu_ms=38.0, both_ms=12.0):
        quiet = {"deadline_misses": 0, "cpu_max_ms": 1.0, "budget_ms": 25.0, "cpu_max_begin_s": 0.0, "cpu_max_end_s": 0.001}
        late = dict(quiet, deadline_misses=misses, cpu_max_ms=cpu_ms, cpu_max_begin_s=10.0, cpu_max_end_s=10.040)
        witness = soak.Witness()
        witness.withheld_s = [[(9.0, 9.9), (10.010, 10.020), (10.035, 10.3)], [(10.0, 10.005)]]
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "out"))
            with open(os.path.join(folder, "out", "summary.json"), "w", encoding="utf-8") as file:
                json.dump({"sensor": late, "matcher": quiet, "filter": quiet, "matcher_and_filter": {"cpu_max_ms": both_ms}},
                          file)
            return soak.machine_broke(soak.Run(types.SimpleNamespace(world="rooms"), folder), broken, witness)

    def test_a_round_that_was_late_by_less_than_was_withheld_in_it(self):
        self.assertTrue(self.blames_the_machine([LATE]))

    def test_not_a_round_that_was_late_by_more(self):
        self.assertFalse(self.blames_the_machine([LATE], cpu_ms=41.0))

    def test_not_where_another_round_was_late_too(self):
        self.assertFalse(self.blames_the_machine([LATE], misses=2))

    def test_not_for_any_other_promise(self):
        self.assertFalse(self.blames_the_machine([LATE, "heap calls"]))
        self.assertFalse(self.blames_the_machine(["position error, largest"], misses=0, cpu_ms=1.0))
        self.assertFalse(self.blames_the_machine([LATE, soak.BOTH_WORST], both_ms=30.0))

    def test_not_where_every_promise_was_kept(self):
        self.assertFalse(self.blames_the_machine([]))


if __name__ == "__main__":
    soak = load(os.path.join(sys.argv[2], "tools", "soak"))
    unittest.main(argv=sys.argv[:1], verbosity=2)
