// How long the matcher and the filter go on after their deadline, on scans that make as much work as scans can.
//
//   bench_deadline [SCANS [DEADLINE]]   CPU time of SCANS scans of each kind, in ms; the deadline is the daemon's
//   count_deadline [SCANS [DEADLINE]]   the same by thousands of basic blocks of the core, which are the same
//   everywhere
//
// Ends with 1 where more was done after a deadline, or between two questions to one, than is stated here.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/odometry/laser_odometry.hpp"
#include "core/slam/lslam.hpp"
#include "core/slam/path_pool.hpp"
#include "rt/cpu_clock.hpp"
#include "tests/bench/deadline/hard_scans.hpp"
#include "tests/bench/deadline/work_counter.hpp"

namespace odoless {
namespace {

constexpr double kUnlimited = 1e18;

/// Milliseconds of CPU time, or thousands of basic blocks.
struct Bounds {
  double deadline;
  double after_max;    ///< most after the deadline
  double unasked_max;  ///< most between two questions to it
};

struct StageBounds {
  Bounds matcher;
  Bounds filter;
  Bounds paths;
};

/// Three quarters of the daemon's budgets; the last quarter is what they end with.
constexpr StageBounds kTimes{{15.0, 5.0, kUnlimited}, {15.0, 5.0, kUnlimited}, {0.0, kUnlimited, kUnlimited}};
constexpr StageBounds kBlocks{{15000.0, 2500.0, 2000.0}, {15000.0, 5500.0, 5500.0}, {0.0, 40.0, kUnlimited}};

/// The clock of a piece of work, that a Deadline asks.
class WorkClock {
 public:
  void begin(double deadline) {
    begin_ = asked_ = now();
    end_ = begin_ + deadline;
  }
  [[nodiscard]] double used() { return ask() - begin_; }
  [[nodiscard]] double longest_step() const { return longest_; }
  [[nodiscard]] Deadline deadline() {
    return {[](const void* self) { return static_cast<WorkClock*>(const_cast<void*>(self))->over(); }, this};
  }

 private:
  [[nodiscard]] double now() const {
    return counts_blocks() ? 1e-3 * static_cast<double>(blocks_run()) : 1e-6 * static_cast<double>(thread_cpu_ns());
  }
  double ask() {
    const double asked = now();
    longest_ = std::max(longest_, asked - asked_);
    return asked_ = asked;
  }
  bool over() { return ask() >= end_; }

  double begin_ = 0.0;
  double end_ = 0.0;
  double asked_ = 0.0;
  double longest_ = 0.0;
};

/// One row of the table.
class Figures {
 public:
  void add(double used) { used_.push_back(used); }

  /// Prints it. Returns whether every bound was kept.
  bool report(const char* stage, const char* kind, const Bounds& bounds, double unasked) {
    std::sort(used_.begin(), used_.end());
    const double worst = used_.back();
    const double median = used_[used_.size() / 2];
    const double most = bounds.deadline + bounds.after_max;
    const auto over = used_.end() - std::upper_bound(used_.begin(), used_.end(), most);
    const bool kept = over == 0 && unasked <= bounds.unasked_max;
    std::printf("%-8s %-20s %7zu %9.2f %9.2f %7.2f %9.2f %9.2f %6td %s\n", stage, kind, used_.size(), median, worst,
                worst / median, std::max(0.0, worst - bounds.deadline), unasked, over, kept ? "" : "BROKEN");
    return kept;
  }

 private:
  std::vector<double> used_;
};

/// One matcher and one filter, driven through scans of a kind.
class Drive {
 public:
  Drive(const StageBounds& bounds, const LslamParams& filter) : bounds_(bounds), filter_(filter, 1) {}

  void scan(ScanFrame scan) {
    matcher_clock_.begin(bounds_.matcher.deadline);
    scan.deskew(odometry_.velocity());
    const Motion motion = odometry_.process(scan, matcher_clock_.deadline(), rng_);
    matcher_figures_.add(matcher_clock_.used());
    filter_clock_.begin(bounds_.filter.deadline);
    static_cast<void>(filter_.update(motion, scan, filter_clock_.deadline()));
    filter_figures_.add(filter_clock_.used());
  }

  bool report(const char* kind) {
    const bool kept = matcher_figures_.report("matcher", kind, bounds_.matcher, matcher_clock_.longest_step());
    return filter_figures_.report("filter", kind, bounds_.filter, filter_clock_.longest_step()) && kept;
  }

 private:
  StageBounds bounds_;
  LaserOdometry odometry_{{}, {}, {}, {}};
  Lslam filter_;
  Rng rng_{1};
  WorkClock matcher_clock_;
  WorkClock filter_clock_;
  Figures matcher_figures_;
  Figures filter_figures_;
};

bool run_kind(HardScans kind, const char* name, int scans, const LslamParams& filter, const StageBounds& bounds) {
  HardScanSource source(kind, 1);
  Drive drive(bounds, filter);
  for (int i = 0; i < scans; ++i) {
    drive.scan(source.next());
  }
  return drive.report(name);
}

/// Every update resamples, and both pools are full.
LslamParams full_of_ancestors() {
  LslamParams params;
  params.resample_below = 1.0;
  params.path_records_max = 16 * params.particles;
  params.grid.tiles_max = 4000;
  return params;
}

/// A million poses, until the pool is thinned; then half of the paths are lost, and the others double.
bool run_paths(const Bounds& bounds) {
  constexpr int kParticles = 100;
  constexpr int kUpdates = 12'000;
  PathPool pool(1'000'000, kParticles);
  std::vector<int> copies(kParticles, 1);
  WorkClock clock;
  Figures figures;
  pool.next_update();
  pool.append(0, {});
  pool.branch(std::vector<int>{kParticles});
  for (int update = 1; update < kUpdates; ++update) {
    clock.begin(0.0);
    pool.next_update();
    if (update == kUpdates / 2) {
      for (std::size_t i = 0; i < copies.size(); ++i) {
        copies[i] = i % 2 == 0 ? 2 : 0;
      }
      pool.retain(copies);
    }
    for (int i = 0; i < kParticles; ++i) {
      if (update != kUpdates / 2 || i % 2 == 0) {
        pool.append(i, {.stamp_ns = update, .map_T_scan = {}});
      }
    }
    if (update == kUpdates / 2) {
      pool.branch(copies);
    }
    figures.add(clock.used());
  }
  return figures.report("paths", "a million poses", bounds, 0.0) && pool.thinned() > 0;
}

int run(int scans, double deadline) {
  StageBounds bounds = counts_blocks() ? kBlocks : kTimes;
  if (deadline > 0.0) {
    bounds.matcher.deadline = bounds.filter.deadline = deadline;
  }
  std::printf("%s: deadline %g, most after it %g (matcher), %g (filter)\n",
              counts_blocks() ? "thousands of basic blocks" : "ms of CPU time", bounds.matcher.deadline,
              bounds.matcher.after_max, bounds.filter.after_max);
  std::printf("%-8s %-20s %7s %9s %9s %7s %9s %9s %6s\n", "stage", "scans", "number", "median", "worst", "ratio",
              "after", "unasked", "over");
  bool kept = true;
  for (std::size_t kind = 0; kind < kHardScanNames.size(); ++kind) {
    kept = run_kind(static_cast<HardScans>(kind), kHardScanNames[kind], scans, {}, bounds) && kept;
  }
  kept = run_kind(HardScans::kRoom, "full of ancestors", scans, full_of_ancestors(), bounds) && kept;
  return run_paths(bounds.paths) && kept ? 0 : 1;
}

}  // namespace
}  // namespace odoless

int main(int argc, char** argv) {
  return odoless::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 200, argc > 2 ? std::atof(argv[2]) : 0.0);
}
