#include "tools/replay/replay.hpp"

#include <malloc.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/check.hpp"
#include "core/scan/laser_mount.hpp"
#include "firmware/world/continued_world.hpp"
#include "firmware/world/world_reader.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/command/error.hpp"
#include "tools/log/log_times.hpp"
#include "tools/replay/mapper.hpp"
#include "tools/replay/summary.hpp"

namespace odoless {
namespace {

double to_s(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) * 1e-9; }

void assign(ScanFrame& frame, const RawScan& mounted, int index) {
  const Errc error = frame.assign(mounted);
  if (error != Errc::kOk) {
    throw UserError(65, "scan " + std::to_string(index) + " of the log: " + describe(error) +
                            "; scan.beams_max in the configuration sets how many beams a scan may have");
  }
}

// A scan that the sensor stage did not take.
[[noreturn]] void refuse(const RawScan& raw, const ScanParams& params, int index) {
  ScanFrame frame(params);
  assign(frame, raw, index);
  ODOLESS_CHECK(false);
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

/// Collects what the stages make of the scans.
class Recorder {
 public:
  explicit Recorder(const ScanLog& log) : log_(log) {}

  [[nodiscard]] ReplayResult& result() { return result_; }

  /// @param time_ns  When the scan was taken, as estimated.
  void add(int index, const ChainStep& step, std::int64_t time_ns) {
    count(step.filter);
    count_gap(time_ns);
    result_.scan_cpu_us.push_back(static_cast<double>(step.matcher_cpu_ns + step.filter_cpu_ns) * 1e-3);
    result_.filter_updates += step.filter.updated ? 1 : 0;
    if (last_index_) {
      add_match(*last_index_, index, step);
    }
    last_index_ = index;
  }

  /// After the last scan: of those that were said to be OK, the ones that were not where the final path has them.
  void count_ok_but_off() {
    ODOLESS_CHECK(result_.online_trajectory.size() == is_sure_.size() && result_.trajectory.size() == is_sure_.size());
    for (std::size_t i = 0; i < is_sure_.size(); ++i) {
      const bool is_right = are_within(result_.online_trajectory[i].map_T_scan, result_.trajectory[i].map_T_scan,
                                       PoseEstimate::kOk_m, PoseEstimate::kOk_rad);
      result_.ok_but_off_scans += is_sure_[i] && !is_right ? 1 : 0;
    }
  }

  /// Whether it is known by now where the robot is in the world.
  void count_place(const SubmapGraph& graph) {
    if (!graph.is_in_world()) {
      is_sure_.back() = false;
      ++(graph.is_guessed() ? result_.guessed_scans : result_.unlocated_scans);
    }
  }

 private:
  static constexpr double kWeight_clear = 0.9;

  void add_match(int reference_index, int index, const ChainStep& step) {
    MatchRow row = row_of(log_, reference_index, index);
    row.reference_T_scan = step.motion.previous_T_current;
    fill_quality(row, step.motion, step.motion.has(kConverged), step.matcher_cpu_ns);
    result_.matches.push_back(row);
    result_.poor_matches += step.motion.has(kConverged) ? 0 : 1;
    result_.retried_matches += step.motion.has(kEscalated) ? 1 : 0;
    result_.ambiguous_matches += step.motion.weight() < kWeight_clear ? 1 : 0;
  }

  void count(const FilterStep& step) {
    const bool lost = step.tracking == Tracking::kLost;
    is_sure_.push_back(step.tracking == Tracking::kSure);
    result_.lost_scans += lost ? 1 : 0;
    result_.drifted_scans += step.has_drifted ? 1 : 0;
    result_.doubtful_scans += step.tracking == Tracking::kDoubtful && !step.has_drifted ? 1 : 0;
    result_.relocalisations += step.found ? 1 : 0;
    result_.outside_scans += step.report.outside_tiles > 0 ? 1 : 0;
    result_.least_fit = lost ? result_.least_fit : std::min(result_.least_fit, step.fit);
  }

  void count_gap(std::int64_t time_ns) {
    constexpr double kGap_s = 1.0;
    const double since_s = to_s(time_ns - last_time_ns_);
    result_.missing_s += last_index_ && since_s > kGap_s ? since_s : 0.0;
    last_time_ns_ = time_ns;
  }

  const ScanLog& log_;
  ReplayResult result_;
  std::vector<bool> is_sure_;  ///< of each scan
  std::optional<int> last_index_;
  std::int64_t last_time_ns_ = 0;
};

/// Goes on with a world, or says that it has no room.
void resume(Mapper& mapper, const ReplayOptions& options, const GraphParams& params) {
  const StoredWorld& world = *options.world;
  if (!mapper.resume(world.world(), options.world_use, last_place(world))) {
    throw UsageError("the world has no room: " + no_room_sentence(world, params));
  }
}

void finish(Mapper& mapper, const ReplayOptions& options, ReplayResult& result) {
  mapper.finish();
  result.trajectory = mapper.trajectory();
  result.online_trajectory = mapper.online_trajectory();
  result.source = mapper.chain().sensor().counts();
  if (const SubmapGraph* const graph = mapper.graph()) {
    if (options.on_graph) {
      options.on_graph(*graph, mapper.odom());
    }
    result.graph = graph->graph();
    result.closures = graph->counts();
    result.outside_scans = 0;  // a map of keyframes has no edge
    mapper.release_stages();
  }
  result.map = mapper.map();
}

}  // namespace

ReplayResult replay(ScanLog log, const RobotParams& params, const ReplayOptions& options,
                    const ReplayProgress& progress, const ReplayWatcher& watcher) {
  const std::vector<int> used = used_scans(log, options.every);
  Mapper mapper(params, options.seed);
  Recorder recorder(log);
  if (options.world != nullptr && params.graph.enabled) {
    resume(mapper, options, params.graph);
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    LogScan& scan = log.scans[static_cast<std::size_t>(used[i])];
    const RawScan raw = scan.raw();
    const ChainStep step = mapper.process(raw, scan.is_level);
    if (step.verdict == ScanVerdict::kMalformed) {
      refuse(raw, params.scan, used[i]);
    }
    if (step.verdict == ScanVerdict::kAccepted) {
      recorder.add(used[i], step, mapper.chain().frame().time_ns());
      if (mapper.graph() != nullptr) {
        recorder.count_place(*mapper.graph());
      }
      if (watcher) {
        watcher(step, raw, mapper.chain());
      }
    }
    scan.ranges_m = std::vector<float>();
    if ((i + 1) * 10 / used.size() > i * 10 / used.size()) {
      ::malloc_trim(0);  // so that what was given back is the system's again
      recorder.result().rss_bytes_by_tenth.push_back(ResourceMeter::rss_bytes());
    }
    progress(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(used.size()), step.motion.fitness);
  }
  finish(mapper, options, recorder.result());
  recorder.count_ok_but_off();
  ReplayResult result = std::move(recorder.result());
  result.log_duration_s = to_s(log.scans[static_cast<std::size_t>(used.back())].stamp_ns - log.scans.front().stamp_ns);
  return result;
}

std::vector<MatchRow> match_pairs(const ScanLog& log, const RobotParams& params, const ReplayOptions& options,
                                  const ReplayProgress& progress) {
  const std::vector<int> used = used_scans(log, options.every);
  const LogTimes times = times_of(log, options.every);
  NdtMatcher matcher(params.matcher);
  MatchReference reference(params.matcher.reference, params.matcher.points_max);
  LaserMount mount(params.mount, params.scan.beams_max);
  ScanFrame previous(params.scan);
  ScanFrame current(params.scan);
  std::vector<MatchRow> rows;
  for (std::size_t i = 1; i < used.size(); ++i) {
    assign(previous, mount.apply(log.scans[static_cast<std::size_t>(used[i - 1])].raw()), used[i - 1]);
    assign(current, mount.apply(log.scans[static_cast<std::size_t>(used[i])].raw()), used[i]);
    Rng rng(options.seed, static_cast<std::uint64_t>(used[i]));  // a pair's result does not depend on the pairs before
    MatchRow row = row_of(log, used[i - 1], used[i]);
    const std::int64_t start_ns = thread_cpu_ns();
    const PlacedScan placed{&previous, {}};
    static_cast<void>(reference.rebuild({&placed, 1}));
    const double estimated_s = to_s(times.times[i].time_ns - times.times[i - 1].time_ns);
    const double period_s = log.has_stamps ? std::max(row.stamp_s - row.reference_stamp_s, estimated_s) : 0.0;
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
