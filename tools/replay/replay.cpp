#include "tools/replay/replay.hpp"

#include <algorithm>
#include <string>

#include "firmware/stages/filter_stage.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/command/error.hpp"
#include "tools/replay/summary.hpp"

namespace odoless {
namespace {

double to_s(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) * 1e-9; }

void assign(ScanFrame& frame, const ScanLog& log, int index) {
  const Errc error = frame.assign(log.scans[static_cast<std::size_t>(index)].raw());
  if (error != Errc::kOk) {
    throw UserError(65, "scan " + std::to_string(index) + " of the log: " + describe(error) +
                            "; scan.beams_max in the configuration sets how many beams a scan may have");
  }
}

std::vector<int> used_scans(const ScanLog& log, int every) {
  std::vector<int> indices;
  for (int i = 0; i < static_cast<int>(log.scans.size()); i += every) {
    indices.push_back(i);
  }
  return indices;
}

// The rows' part that is the same for pairs and for tracking.
MatchRow row_of(const ScanLog& log, int reference_index, int index) {
  MatchRow row;
  row.reference_index = reference_index;
  row.index = index;
  row.reference_stamp_s = to_s(log.scans[static_cast<std::size_t>(reference_index)].stamp_ns);
  row.stamp_s = to_s(log.scans[static_cast<std::size_t>(index)].stamp_ns);
  return row;
}

// Of a Motion or a MatchResult.
template <class Match>
void fill_quality(MatchRow& row, const Match& match, bool converged, std::int64_t cpu_ns) {
  row.fitness = match.fitness;
  row.evaluations = match.evaluations;
  row.converged = converged;
  row.time_us = static_cast<double>(cpu_ns) * 1e-3;
}

// Each scan hangs on the filter update before it; the best particle's final path says where that update was.
std::vector<StampedPose> final_trajectory(const std::vector<StampedPose>& path, const std::vector<FilterStep>& steps,
                                          const std::vector<int>& updates, const std::vector<StampedPose>& online) {
  std::vector<StampedPose> out = online;
  if (static_cast<int>(path.size()) != (updates.empty() ? 0 : updates.back() + 1)) {
    return out;  // thinned paths: the poses of the time stand
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].map_T_scan = path[static_cast<std::size_t>(updates[i])].map_T_scan * steps[i].update_T_scan;
  }
  return out;
}

void count(const FilterStep& step, ReplayResult& result) {
  const bool lost = step.tracking == Tracking::kLost;
  result.lost_scans += lost ? 1 : 0;
  result.doubtful_scans += step.tracking == Tracking::kDoubtful ? 1 : 0;
  result.relocalisations += step.found ? 1 : 0;
  result.least_fit = lost ? result.least_fit : std::min(result.least_fit, step.fit);
}

}  // namespace

ReplayResult replay(const ScanLog& log, const RobotParams& params, const ReplayOptions& options,
                    const ReplayProgress& progress) {
  const std::vector<int> used = used_scans(log, options.every);
  MatcherStage matcher(params, options.seed);
  FilterStage filter(params, options.seed);
  ScanFrame frame(params.scan);
  ReplayResult result;
  std::vector<FilterStep> steps;
  std::vector<int> updates;
  for (std::size_t i = 0; i < used.size(); ++i) {
    assign(frame, log, used[i]);
    const std::int64_t start_ns = thread_cpu_ns();
    const Motion motion = matcher.process(frame);
    const std::int64_t cpu_ns = thread_cpu_ns() - start_ns;
    steps.push_back(filter.process(frame, motion));
    result.scan_cpu_us.push_back(static_cast<double>(thread_cpu_ns() - start_ns) * 1e-3);
    count(steps.back(), result);
    if ((i + 1) * 10 / used.size() > i * 10 / used.size()) {
      result.rss_bytes_by_tenth.push_back(ResourceMeter::rss_bytes());
    }
    result.filter_updates += steps.back().updated ? 1 : 0;
    updates.push_back(result.filter_updates - 1);
    result.online_trajectory.push_back({frame.stamp_ns(), steps.back().map_T_scan});
    if (i > 0) {
      MatchRow row = row_of(log, used[i - 1], used[i]);
      row.reference_T_scan = motion.previous_T_current;
      fill_quality(row, motion, motion.has(kConverged), cpu_ns);
      result.matches.push_back(row);
      result.poor_matches += motion.has(kConverged) ? 0 : 1;
      result.retried_matches += motion.has(kEscalated) ? 1 : 0;
    }
    progress(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(used.size()), motion.fitness);
  }
  filter.filter().finish();
  std::vector<StampedPose> path;
  filter.filter().write_path(path);
  result.trajectory = final_trajectory(path, steps, updates, result.online_trajectory);
  filter.filter().write_occupancy(result.map);
  result.log_duration_s = to_s(log.scans[static_cast<std::size_t>(used.back())].stamp_ns - log.scans.front().stamp_ns);
  return result;
}

std::vector<MatchRow> match_pairs(const ScanLog& log, const RobotParams& params, const ReplayOptions& options,
                                  const ReplayProgress& progress) {
  const std::vector<int> used = used_scans(log, options.every);
  NdtMatcher matcher(params.matcher);
  MatchReference reference(params.matcher.reference, params.matcher.points_max);
  ScanFrame previous(params.scan);
  ScanFrame current(params.scan);
  std::vector<MatchRow> rows;
  for (std::size_t i = 1; i < used.size(); ++i) {
    assign(previous, log, used[i - 1]);
    assign(current, log, used[i]);
    Rng rng(options.seed, static_cast<std::uint64_t>(used[i]));  // a pair's result does not depend on the pairs before
    MatchRow row = row_of(log, used[i - 1], used[i]);
    const std::int64_t start_ns = thread_cpu_ns();
    const PlacedScan placed{&previous, {}};
    static_cast<void>(reference.rebuild({&placed, 1}));
    const double period_s = log.has_stamps ? row.stamp_s - row.reference_stamp_s : 0.0;
    const Expectation expected = expect_rest(params.limits, period_s);
    const Result<MatchResult> match = matcher.match(reference, current, expected, {}, rng);
    const std::int64_t cpu_ns = thread_cpu_ns() - start_ns;
    const MatchResult found = match.ok() ? match.value() : MatchResult{};  // nothing to match: no motion, fitness 0
    row.reference_T_scan = found.reference_T_scan;
    fill_quality(row, found, found.converged, cpu_ns);
    rows.push_back(row);
    progress(static_cast<std::int64_t>(i), static_cast<std::int64_t>(used.size()) - 1, found.fitness);
  }
  return rows;
}

}  // namespace odoless
