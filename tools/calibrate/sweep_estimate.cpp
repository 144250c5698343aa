#include "tools/calibrate/sweep_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/stages/matcher_stage.hpp"
#include "firmware/stages/sensor_stage.hpp"

namespace odoless {
namespace {

constexpr double kClearly_better_scores = 1.03;  // less is what the local map makes of it
constexpr double kStandard_errors = 4.0;
constexpr std::int64_t kSweep_max_ns = 500'000'000;
constexpr int kQuarters = 4;

/// Laser odometry with one sweep.
struct SweepTrial {
  std::int64_t sweep_ns = 0;
  std::vector<double> scores{};  ///< one for each scan; 0 where there was no match
  std::vector<double> turns_rad{};
};

SweepTrial try_sweep(std::int64_t sweep_ns, const ScanLog& log, RobotParams params) {
  params.mount.sweep_ns = sweep_ns;
  SensorStage sensor(false, params.scan.beams_max, params.mount);
  MatcherStage matcher(params, 1);
  ScanFrame frame(params.scan);
  SweepTrial trial{.sweep_ns = sweep_ns};
  for (const LogScan& scan : log.scans) {
    const RawScan raw = scan.raw();
    const bool is_taken = sensor.process(raw, raw.stamp_ns, frame) == ScanVerdict::kAccepted && scan.is_level;
    const Motion motion = is_taken ? matcher.process(frame) : Motion{};
    trial.scores.push_back(motion.matched() ? motion.score : 0.0);
    trial.turns_rad.push_back(motion.matched() ? motion.previous_T_current.yaw_rad : 0.0);
  }
  return trial;
}

std::int64_t median_period_ns(const ScanLog& log) {
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    periods.push_back(log.scans[i].stamp_ns - log.scans[i - 1].stamp_ns);
  }
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return *middle;
}

/// Of the scans in turns: how many times better one run's scores are than another's, in the mean of their logarithms.
struct Comparison {
  int scans = 0;
  double better = 1.0;
  bool is_clear = false;
};

Comparison compare(const SweepTrial& one, const SweepTrial& other) {
  double sum = 0.0;
  double sum2 = 0.0;
  Comparison found;
  for (std::size_t i = 0; i < one.scores.size(); ++i) {
    if (std::abs(one.turns_rad[i]) < SweepEstimate::kTurn_min_rad || one.scores[i] <= 0.0 || other.scores[i] <= 0.0) {
      continue;
    }
    const double ratio = std::log(one.scores[i] / other.scores[i]);
    ++found.scans;
    sum += ratio;
    sum2 += ratio * ratio;
  }
  if (found.scans > 0) {
    const double mean = sum / found.scans;
    const double variance = std::max(0.0, sum2 / found.scans - mean * mean) / found.scans;
    found.better = std::exp(mean);
    found.is_clear = found.scans >= SweepEstimate::kTurnScans_min && found.better >= kClearly_better_scores &&
                     mean >= kStandard_errors * std::sqrt(variance);
  }
  return found;
}

}  // namespace

SweepEstimate estimate_sweep(const ScanLog& log, const RobotParams& params, const SweepProgress& progress) {
  const std::int64_t period_ns = median_period_ns(log);
  const std::int64_t quarter_ns = std::min(period_ns, kSweep_max_ns) / kQuarters;
  std::vector<SweepTrial> trials;
  for (std::int64_t quarters = -kQuarters; quarters <= kQuarters; ++quarters) {
    progress(static_cast<int>(trials.size()), 2 * kQuarters + 1);
    trials.push_back(try_sweep(quarters * quarter_ns, log, params));
  }
  progress(static_cast<int>(trials.size()), static_cast<int>(trials.size()));
  const SweepTrial& at_once = trials[kQuarters];
  const SweepTrial& best = *std::ranges::max_element(
      trials, {}, [&at_once](const SweepTrial& trial) { return compare(trial, at_once).better; });
  const Comparison won = compare(best, at_once);
  SweepEstimate found{.period_ns = period_ns, .turn_scans = won.scans, .better = won.better};
  if (won.is_clear) {
    found.verdict = SweepEstimate::Verdict::kSweep;
    found.sweep_ns = best.sweep_ns;
  } else if (compare(at_once, trials.front()).is_clear && compare(at_once, trials.back()).is_clear) {
    found.verdict = SweepEstimate::Verdict::kShort;
  }
  return found;
}

}  // namespace odoless
