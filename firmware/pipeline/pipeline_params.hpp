#pragma once

#include <cstdint>

#include "core/base/parameters.hpp"

namespace odoless {

/// Threads, queues and time budgets of the daemon.
struct PipelineParams {
  int scan_queue = 8;
  int motion_queue = 64;
  std::int64_t matcher_budget_ns = 20'000'000;
  std::int64_t filter_budget_ns = 20'000'000;
  std::int64_t scan_budget_ns = 25'000'000;
  int particles_min = 10;
  std::int64_t watchdog_ns = 2'000'000'000;
  int sensor_priority = 60;
  int matcher_priority = 50;
  int filter_priority = 40;
  int sensor_cpu = -1;
  int matcher_cpu = -1;
  int filter_cpu = -1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("scan_queue", self.scan_queue, Range{1, 1024},
                "Scans that can wait for the matcher; when the queue is full the oldest is dropped and counted.");
    visit.value(
        "motion_queue", self.motion_queue, Range{1, 4096},
        "Motions that can wait for the filter; when the queue is full the matcher adds them up, so that none is lost.");
    visit.value("matcher_budget_ns", self.matcher_budget_ns, Range<std::int64_t>{1'000'000, 10'000'000'000},
                "CPU time for one match; after three quarters of it the search ends with the best so far. Not used in "
                "a replay.");
    visit.value("filter_budget_ns", self.filter_budget_ns, Range<std::int64_t>{1'000'000, 10'000'000'000},
                "CPU time for one update of the filter; particles adapt to it. Not used in a replay.");
    visit.value("scan_budget_ns", self.scan_budget_ns, Range<std::int64_t>{1'000'000, 20'000'000'000},
                "CPU time for match and filter update of one scan together: the filter gets what the match has left. "
                "Not used in a replay.");
    visit.value("particles_min", self.particles_min, Range{1, 10'000}, "Fewest particles, however short the time is.");
    visit.value(
        "watchdog_ns", self.watchdog_ns, Range<std::int64_t>{50'000'000, 60'000'000'000},
        "Time without an answer after which a stage counts as hung, time that it waits for a processor aside: the "
        "daemon ends with status 70, to be restarted.");
    visit.value("sensor_priority", self.sensor_priority, Range{0, 98},
                "Priority (SCHED_FIFO) of the sensor thread; 0: an ordinary thread.");
    visit.value("matcher_priority", self.matcher_priority, Range{0, 98}, "The same of the matcher thread.");
    visit.value("filter_priority", self.filter_priority, Range{0, 98}, "The same of the filter thread.");
    visit.value("sensor_cpu", self.sensor_cpu, Range{-1, 1023}, "Processor of the sensor thread; -1: any.");
    visit.value("matcher_cpu", self.matcher_cpu, Range{-1, 1023}, "The same of the matcher thread.");
    visit.value("filter_cpu", self.filter_cpu, Range{-1, 1023}, "The same of the filter thread.");
  }
};

}  // namespace odoless
