"""What tools/soak does not count as the daemon's time: what the machine withheld from it, and nothing else."""

import importlib.machinery
import importlib.util
import os
import sys
import time
import unittest


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


class RoundsTest(unittest.TestCase):
    """Of a stage with a budget of 25 ms; at 10 s, one processor was withheld for 15 ms and another one for 5 ms."""

    def rounds(self, *begin_end_cpu, misses=1):
        witness = soak.Witness()
        witness.withheld_s = [[(9.0, 9.9), (10.010, 10.020), (10.035, 10.3)], [(10.0, 10.005)]]
        return soak.Rounds({"budget_ms": 25.0, "deadline_misses": misses,
                            "longest_rounds_begin_s_end_s_cpu_ms": begin_end_cpu}, witness)

    def test_a_round_was_not_late_by_what_was_withheld_in_it(self):
        rounds = self.rounds((10.001, 10.040, 38.5), (11.0, 11.008, 8.0))
        self.assertEqual(rounds.own_misses(), 0)
        self.assertAlmostEqual(rounds.own_max_ms(), 24.0)

    def test_a_round_was_late_by_more(self):
        rounds = self.rounds((9.998, 10.040, 42.0), (11.0, 11.008, 8.0))
        self.assertEqual(rounds.own_misses(), 1)
        self.assertAlmostEqual(rounds.own_max_ms(), 27.0)

    def test_what_the_machine_told_of_and_nobody_counted_excuses_nothing(self):
        rounds = self.rounds((10.0, 10.042, 27.0))
        self.assertEqual(rounds.own_misses(), 1)
        self.assertAlmostEqual(rounds.own_max_ms(), 27.0)

    def test_another_round_was_late_too(self):
        late = (12.0, 12.030, 30.0)
        self.assertEqual(self.rounds((10.001, 10.040, 38.5), late, misses=2).own_misses(), 1)
        self.assertEqual(self.rounds((10.001, 10.040, 38.5), misses=2).own_misses(), 1, "one that is not among the longest")
        self.assertAlmostEqual(self.rounds((10.001, 10.040, 38.5), late, misses=2).own_max_ms(), 30.0)

    def test_a_stage_without_a_round(self):
        self.assertEqual(self.rounds(misses=0).own_misses(), 0)
        self.assertEqual(self.rounds(misses=0).own_max_ms(), 0.0)


if __name__ == "__main__":
    soak = load(os.path.join(sys.argv[2], "tools", "soak"))
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
