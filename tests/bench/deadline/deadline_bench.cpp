// How long the matcher and the filter go on after their deadline, on scans that make as much work as scans can.
//
//   bench_deadline [SCANS [DEADLINE]]   CPU time of SCANS scans of each kind, in ms; the deadline is the daemon's
//   count_deadline [SCANS [DEADLINE]]   the same by thousands of basic blocks of the core, which are the same
//   everywhere
//
// "least" is the filter with the fewest particles that the daemon goes down to, "plain" what a scan takes where there
// is no deadline (median of a twentieth of the scans). Ends with 1 where more was done after a deadline, or between two
// questions to one, than is stated here.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/odometry/laser_odometry.hpp"
#include "core/slam/lslam.hpp"
#include "core/slam/path_pool.hpp"
#include "tests/bench/deadline/hard_scans.hpp"
#include "tests/bench/deadline/work_counter.hpp"
#include "tests/bench/deadline/work_figures.hpp"

namespace odoless {
namespace {

constexpr int kLeastParticles = 10;  // PipelineParams::particles_min

struct StageBounds {
  Bounds matcher;
  Bounds filter;
  Bounds ancestors;
  Bounds paths;
};

/// Three quarters of the daemon's budgets; the last quarter is what they end with.
constexpr StageBounds kTimes{.matcher = {15.0, 5.0}, .filter = {15.0, 5.0}, .ancestors = {0.0, 5.0}, .paths = {0.0}};
constexpr StageBounds kBlocks{.matcher = {15000.0, 2500.0, 2000.0},
                              .filter = {15000.0, 1300.0, 1700.0},
                              .ancestors = {0.0, 3000.0, 1700.0},
                              .paths = {0.0, 40.0}};

/// A filter, and what its updates took.
class FilterDrive {
 public:
  FilterDrive(const LslamParams& params, int particles) : filter_(params, 1) { filter_.set_particles(particles); }

  void update(const Motion& motion, const ScanFrame& scan, double deadline) {
    clock_.begin(deadline);
    static_cast<void>(filter_.update(motion, scan, clock_.deadline()));
    const double used = clock_.used();
    if (deadline < kUnlimited) {
      figures_.add(used);
    } else {
      whole_.add(used);
    }
  }
  bool report(const char* stage, const char* kind, const Bounds& bounds, double plain) {
    return figures_.report(stage, kind, bounds, clock_.longest_step(), plain);
  }
  /// Of the updates without a deadline.
  [[nodiscard]] double median_whole() { return whole_.median(); }

 private:
  Lslam filter_;
  WorkClock clock_;
  Figures figures_;
  Figures whole_;
};

/// A matcher and two filters, driven through scans of a kind.
class Drive {
 public:
  Drive(const StageBounds& bounds, const LslamParams& filter)
      : bounds_(bounds),
        odometry_({}, {}, {}, {}),
        filter_(filter, filter.particles),
        least_(filter, kLeastParticles) {}

  void scan(ScanFrame scan) {
    matcher_clock_.begin(bounds_.matcher.deadline);
    const Motion motion = odometry_.process(scan, matcher_clock_.deadline(), rng_);
    matcher_figures_.add(matcher_clock_.used());
    filter_.update(motion, scan, bounds_.filter.deadline);
    least_.update(motion, scan, bounds_.filter.deadline);
  }

  /// @param plain  The same without a deadline.
  bool report(const char* kind, Drive& plain) {
    const bool kept[] = {
        matcher_figures_.report("matcher", kind, bounds_.matcher, matcher_clock_.longest_step(),
                                plain.matcher_figures_.median()),
        filter_.report("filter", kind, bounds_.filter, plain.filter_.median_whole()),
        least_.report("least", kind, bounds_.filter, plain.least_.median_whole()),
    };
    return kept[0] && kept[1] && kept[2];
  }

 private:
  StageBounds bounds_;
  LaserOdometry odometry_;
  Rng rng_{1};
  WorkClock matcher_clock_;
  Figures matcher_figures_;
  FilterDrive filter_;
  FilterDrive least_;
};

bool run_kind(HardScans kind, int scans, const StageBounds& bounds) {
  HardScanSource source(kind, 1);
  const LslamParams filter;
  const StageBounds none;
  Drive plain(none, filter);
  Drive product(bounds, filter);
  for (int i = 0; i < scans; ++i) {
    const ScanFrame scan = source.next();
    if (i < std::max(2, scans / 20)) {
      plain.scan(scan);
    }
    product.scan(scan);
  }
  return product.report(kHardScanNames[static_cast<std::size_t>(kind)], plain);
}

/// Every update resamples, and both pools are full: two updates without a deadline, then one that ends at once and
/// gives nearly all particles up.
bool run_ancestors(int updates, const Bounds& bounds) {
  LslamParams params;
  params.resample_below = 1.0;
  params.path_records_max = 16 * params.particles;
  FilterDrive filter(params, params.particles);
  HardScanSource source(HardScans::kFar, 1);
  for (int i = 0; i < updates; ++i) {
    const Motion motion = Motion::between(i * HardScanSource::kPeriod_ns, (i + 1) * HardScanSource::kPeriod_ns,
                                          {.x_m = 0.02, .y_m = 0.0, .yaw_rad = 0.1});
    filter.update(motion, source.next(), i % 3 == 2 ? bounds.deadline : kUnlimited);
  }
  return filter.report("filter", "full of ancestors", bounds, filter.median_whole());
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
  return figures.report("paths", "a million poses", bounds, 0.0, 0.0) && pool.thinned() > 0;
}

int run(int scans, double deadline) {
  StageBounds bounds = counts_blocks() ? kBlocks : kTimes;
  if (deadline > 0.0) {
    bounds.matcher.deadline = bounds.filter.deadline = deadline;
  }
  std::printf("%s: deadline %g, most after it %g (matcher), %g (filter)\n",
              counts_blocks() ? "thousands of basic blocks" : "ms of CPU time", bounds.matcher.deadline,
              bounds.matcher.after_max, bounds.filter.after_max);
  Figures::print_head();
  bool kept = true;
  for (std::size_t kind = 0; kind < kHardScanNames.size(); ++kind) {
    kept = run_kind(static_cast<HardScans>(kind), scans, bounds) && kept;
  }
  kept = run_ancestors(std::max(6, scans / 10), bounds.ancestors) && kept;
  return run_paths(bounds.paths) && kept ? 0 : 1;
}

}  // namespace
}  // namespace odoless

int main(int argc, char** argv) {
  return odoless::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 200, argc > 2 ? std::atof(argv[2]) : 0.0);
}
