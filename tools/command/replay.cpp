#include "tools/command/replay.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "config/robot_params.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/health/health_text.hpp"
#include "tools/command/closing.hpp"
#include "tools/command/error.hpp"
#include "tools/log/log_times.hpp"
#include "tools/log/plausibility.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/output/g2o.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
#include "tools/output/matches.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/result_folder.hpp"
#include "tools/output/sha256.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/output/world_output.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_mcap.hpp"
#include "tools/replay/replay_page.hpp"
#include "tools/replay/summary.hpp"
#include "tools/replay/verdict.hpp"

namespace odoless {
namespace {

constexpr Rgb kEstimateColour{220, 50, 32};
constexpr Rgb kOnlineColour{230, 159, 0};
constexpr Rgb kTruthColour{0, 90, 181};

struct LogJob {
  std::string log;
  std::string topic;
  std::filesystem::path out;
  std::string config;
  std::string truth;
  std::string web;
  std::filesystem::path world;
  double period_ms = 200.0;
  bool strict = false;
  bool force = false;
  bool mcap = false;
  bool localise = false;
  ReplayOptions options;
};

RobotParams load(const std::string& config) {
  DaemonParams params;  // a robot's file says more than a replay needs
  if (!config.empty()) {
    load_parameters(config, params);
  }
  return params.robot;
}

/// A log that can be a laser's; what was corrected for that is said.
ScanLog read_log(const LogJob& job, std::vector<std::string>& corrected) {
  ScanLog log = read_plausible_log(
      job.log, {.default_period_ns = static_cast<std::int64_t>(job.period_ms * 1e6), .topic = job.topic}, corrected);
  tell_corrections(job.log, corrected);
  return log;
}

/// What came of a job, for people and for `summary.json`.
struct Outcome {
  RunFigures figures{};
  Verdict verdict{};
  std::vector<std::string> corrected;  ///< in the log
  ScanTimeFindings times{};
  bool is_sweep_known = true;  ///< else a scan counts as measured at once
};

ReplayProgress show_on(Progress& bar) {
  return [&bar](std::int64_t done, std::int64_t, double fitness) {
    bar.update(done, fmt::format("fitness {:.2f} (A - score {:.0f})", fitness, 180.0 * (1.0 - fitness)));
  };
}

/// Either may be empty.
ReplayWatcher both(ReplayWatcher first, ReplayWatcher second) {
  if (!first || !second) {
    return first ? first : second;
  }
  return [first, second](const ChainStep& step, const RawScan& raw, StageChain& chain) {
    first(step, raw, chain);
    second(step, raw, chain);
  };
}

std::int64_t scans_used(const ScanLog& log, int every) {
  return (static_cast<std::int64_t>(log.scans.size()) + every - 1) / every;
}

nlohmann::ordered_json to_json(const ScanTimeFindings& times) {
  return {{"out_of_order", times.out_of_order},   {"bunched", times.bunched},       {"gaps", times.gaps},
          {"longest_gap_s", times.longest_gap_s}, {"clock_sets", times.clock_sets}, {"moved", times.moved},
          {"doubtful", times.doubtful},           {"period_s", times.period_s},     {"waver_s", times.waver_s}};
}

void add_outcome(const Outcome& outcome, nlohmann::ordered_json& summary) {
  add_verdict(outcome.figures, outcome.verdict, summary);
  summary["corrected"] = outcome.corrected;
  summary["stamps"] = to_json(outcome.times);
}

/// The closing lines.
void close(const LogJob& job, const Outcome& outcome) {
  fmt::print("{}\nstamps: {}\n", shares_text(outcome.figures), times_text(outcome.times));
  if (!outcome.is_sweep_known && outcome.verdict.grade != Grade::kGood) {
    fmt::print("sweep: {}\n", kSweepNotTold);
  }
  close_job(job.log, outcome.verdict, job.strict);
}

void write_summary(const std::filesystem::path& folder, const nlohmann::ordered_json& summary) {
  write_whole_file(folder / kSummaryFile, summary.dump(2) + "\n");
}

std::string title_of(const LogJob& job) { return std::filesystem::path(job.log).filename().string(); }

// The true path, where one is given, moved so that both paths begin in one pose; it is drawn and nothing else.
std::vector<ColouredPath> paths_to_draw(const LogJob& job, std::span<const StampedPose> final_path,
                                        std::span<const StampedPose> online_path) {
  std::vector<ColouredPath> paths;
  const auto poses_of = [](std::span<const StampedPose> trajectory) {
    std::vector<Pose2> poses;
    std::ranges::transform(trajectory, std::back_inserter(poses), &StampedPose::map_T_scan);
    return poses;
  };
  const ColouredPath estimate{poses_of(final_path), kEstimateColour, "path (final)"};
  paths.push_back({poses_of(online_path), kOnlineColour, "path (online)"});
  if (!job.truth.empty()) {
    ColouredPath truth{{}, kTruthColour, "true path"};
    const ReferencePoses reference = read_reference_poses(job.truth);
    const Pose2 map_T_world = estimate.poses.front() * reference.poses.front().pose.inverse();
    for (const ReferencePose& pose : reference.poses) {
      truth.poses.push_back(map_T_world * pose.pose);
    }
    paths.push_back(truth);
  }
  paths.push_back(estimate);
  return paths;
}

void write_replay(const LogJob& job, const std::filesystem::path& folder, const ReplayResult& result,
                  const LaserPlace& laser, nlohmann::ordered_json summary) {
  const std::vector<StampedPose> trajectory = robot_trajectory(result.trajectory, laser);
  write_trajectory(folder / "trajectory.tum", trajectory);
  const std::vector<StampedPose> online = robot_trajectory(result.online_trajectory, laser);
  write_trajectory(folder / "trajectory_online.tum", online);
  write_matches(folder / "matches.csv", result.matches);
  if (!result.map.occupancy_percent.empty()) {
    write_map(folder, result.map);
    write_map_picture(folder / "map.png", result.map, paths_to_draw(job, trajectory, online), title_of(job));
  }
  if (result.graph) {
    write_whole_file(folder / "pose_graph.g2o", format_g2o(*result.graph));
    if (result.graph->size() > 0 && !result.map.occupancy_percent.empty()) {
      write_graph_picture(folder / "pose_graph.png", result.map, *result.graph, title_of(job) + ": pose graph");
    }
    if (!job.world.empty()) {
      summary["unlocated_scans"] = result.unlocated_scans;
      summary["guessed_scans"] = result.guessed_scans;
    }
    summary["submaps"] = result.graph->size();
    summary["loop_closures"] = result.closures.accepted - result.closures.taken_out;
    summary["loop_closures_taken_out"] = result.closures.taken_out;
  }
  summary["retried_matches"] = result.retried_matches;
  summary["filter_updates"] = result.filter_updates;
  summary["lost_scans"] = result.lost_scans;
  summary["relocalisations"] = result.relocalisations;
  summary["least_fit"] = result.least_fit;
  summary["scan_mean_us_by_tenth"] = mean_by_tenth(result.scan_cpu_us);
  summary["rss_bytes_by_tenth"] = result.rss_bytes_by_tenth;
  summary["sha256"] = sha256_of_file(folder / "trajectory.tum");
  write_summary(folder, summary);
}

/// Where a world file is asked for: the pose graph goes there in the end, unless it stays as it is. It is opened now,
/// before the work.
void keep_world(const LogJob& job, const RobotParams& params, ReplayOptions& options) {
  if (job.world.empty()) {
    if (job.localise) {
      throw UsageError("--localise needs the world to find the way in: --world FILE");
    }
    return;
  }
  if (!params.graph.enabled) {
    throw UsageError("--world needs the pose graph, and graph.enabled is false");
  }
  options.world_use = job.localise ? WorldUse::kLocalise : WorldUse::kContinue;
  auto file = std::make_shared<WorldOutput>(job.world, ODOLESS_VERSION, params, options.world_use);
  if (file->left_out() > 0) {
    fmt::print(stderr, "{}: {} submaps are left out, of which newer visits have seen the ground\n", job.world.string(),
               file->left_out());
  }
  options.world = file->world();
  options.on_graph = [file = std::move(file), session = SessionRecord{utc_text(), ODOLESS_VERSION, write_toml(params),
                                                                      static_cast<std::int64_t>(job.options.seed)}](
                         const SubmapGraph& graph, std::span<const StampedPose> odom) {
    file->write(session, graph, odom);
  };
}

void run_replay(const LogJob& job) {
  const RobotParams params = load(job.config);
  if (!job.truth.empty()) {
    static_cast<void>(read_reference_poses(job.truth));  // what is wrong with it is better said before the work
  }
  const ResourceMeter meter;
  Outcome outcome;
  ScanLog log = read_log(job, outcome.corrected);
  outcome.is_sweep_known = params.mount.sweep_ns != 0 || log.scans.front().beam_period_ns != 0;
  ResultFolder folder(job.out, job.force);
  ReplayOptions options = job.options;
  keep_world(job, params, options);
  const auto page = job.web.empty() ? nullptr : std::make_unique<ReplayPage>(job.web);
  const auto mcap = job.mcap ? std::make_unique<ReplayMcap>(folder.unfinished() / "replay.mcap") : nullptr;
  const std::int64_t scans = scans_used(log, job.options.every);
  ReplayResult result;
  {
    Progress bar(scans, InPipe::kLines);
    result = replay(std::move(log), params, options, show_on(bar),
                    both(page ? page->watcher() : ReplayWatcher(), mcap ? mcap->watcher() : ReplayWatcher()));
  }
  if (mcap) {
    mcap->finish(result);
  }
  outcome.figures = figures_of(result);
  outcome.verdict = judge(outcome.figures);
  outcome.times = result.source.times;
  nlohmann::ordered_json summary = summarise(result.matches, scans, result.log_duration_s, meter);
  add_outcome(outcome, summary);
  write_replay(job, folder.unfinished(), result, LaserPlace::of(params.mount), summary);
  folder.finish();
  fmt::print("{} scans in {:.1f} s, {:.1f} times as fast as recorded; {}\n", scans, summary["wall_s"].get<double>(),
             summary["realtime_factor"].get<double>(),
             outcome.figures.is_mapped ? fmt::format("map in {}", (job.out / "map.png").string()) : "no map");
  close(job, outcome);
  if (!outcome.figures.is_mapped) {
    throw DataError(job.log, 0, "nothing was mapped", "ranges between scan.range_min_m and scan.range_max_m");
  }
  if (page) {
    page->stay();
  }
}

void run_match(const LogJob& job) {
  const RobotParams params = load(job.config);
  const ResourceMeter meter;
  Outcome outcome;
  const ScanLog log = read_log(job, outcome.corrected);
  ResultFolder folder(job.out, job.force);
  const std::int64_t scans = scans_used(log, job.options.every);
  std::vector<MatchRow> rows;
  {
    Progress bar(scans - 1, InPipe::kLines);
    rows = match_pairs(log, params, job.options, show_on(bar));
  }
  write_matches(folder.unfinished() / "matches.csv", rows);
  const double duration_s = rows.empty() ? 0.0 : rows.back().stamp_s - rows.front().reference_stamp_s;
  outcome.figures = figures_of(rows);
  outcome.times = times_of(log, job.options.every).findings;
  outcome.figures.untimed = outcome.times.doubtful;
  outcome.verdict = judge(outcome.figures);
  nlohmann::ordered_json summary = summarise(rows, scans, duration_s, meter);
  add_outcome(outcome, summary);
  write_summary(folder.unfinished(), summary);
  folder.finish();
  fmt::print("{} matches, median {:.0f} us, worst {:.0f} us; {} poor; {}\n", rows.size(),
             summary["match_median_us"].get<double>(), summary["match_max_us"].get<double>(),
             summary["poor_matches"].get<int>(), (job.out / "matches.csv").string());
  close(job, outcome);
}

CLI::App* add_log_job(CLI::App& app, const char* name, const char* what, LogJob& job) {
  CLI::App* const command = app.add_subcommand(name, what);
  command->add_option("LOG", job.log, "Recorded log, of any kind that `odoless info` reads")->required();
  command->add_option("--topic", job.topic, "Topic of the scans, where a log of messages has several");
  command->add_option("--out", job.out, "Folder for the results, new or empty")->required();
  command->add_flag("--force", job.force, "Replace the results that are in the folder");
  command->add_option("--config", job.config, "TOML file that overrides defaults (see `odoless config defaults`)");
  command->add_option("--every", job.options.every, "Use every N-th scan")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", job.options.seed, "Random seed: the same seed gives the same bytes")
      ->capture_default_str();
  command->add_option("--period-ms", job.period_ms, "Time between scans of a log without stamps")
      ->check(CLI::Range(0.001, 1e6))
      ->capture_default_str();
  command->add_flag("--strict", job.strict, "Exit with 65 where the result is not good");
  return command;
}

}  // namespace

void add_replay(CLI::App& app) {
  const auto job = std::make_shared<LogJob>();
  CLI::App* const command = add_log_job(app, "replay", "Map a recorded log with the laser alone", *job);
  command->add_option("--truth", job->truth, "True poses, only drawn into the picture: TUM, `stamp x y yaw`, or a log");
  command->add_option("--world", job->world,
                      "World file to add this replay to as a session; made where it is not there");
  command->add_flag("--localise", job->localise, "Leave the world of --world as it is, and only find the way in it");
  command->add_flag("--mcap", job->mcap,
                    "Write replay.mcap, for Foxglove or ROS 2: scans, poses, frames, health, map and path");
  command->add_option("--web", job->web, "ADDRESS:PORT of a page that shows the replay, until interrupted");
  command->callback([job] { run_replay(*job); });
}

void add_match(CLI::App& app) {
  const auto job = std::make_shared<LogJob>();
  CLI::App* const command =
      add_log_job(app, "match", "Match each scan to the one before, without filter and map", *job);
  command->callback([job] { run_match(*job); });
}

}  // namespace odoless
