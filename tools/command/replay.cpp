#include "tools/command/replay.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <vector>

#include "config/config.hpp"
#include "config/robot_params.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "tools/command/error.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
#include "tools/output/matches.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/sha256.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/summary.hpp"

namespace odoless {
namespace {

constexpr Rgb kEstimateColour{220, 50, 32};
constexpr Rgb kTruthColour{0, 90, 181};

struct LogJob {
  std::string log;
  std::filesystem::path out;
  std::string config;
  std::string truth;
  double period_ms = 200.0;
  ReplayOptions options;
};

RobotParams load(const std::string& config) {
  DaemonParams params;  // a robot's file says more than a replay needs
  if (!config.empty()) {
    load_parameters(config, params);
  }
  return params.robot;
}

ScanLog read_log(const LogJob& job) { return read_scan_log(job.log, static_cast<std::int64_t>(job.period_ms * 1e6)); }

ReplayProgress show_on(Progress& bar) {
  return [&bar](std::int64_t done, std::int64_t, double fitness) {
    bar.update(done, fmt::format("fitness {:.2f} (A - score {:.0f})", fitness, 180.0 * (1.0 - fitness)));
  };
}

std::int64_t scans_used(const ScanLog& log, int every) {
  return (static_cast<std::int64_t>(log.scans.size()) + every - 1) / every;
}

void write_summary(const LogJob& job, const nlohmann::ordered_json& summary) {
  write_whole_file(job.out / "summary.json", summary.dump(2) + "\n");
}

// The true path, where one is given, moved so that both paths begin in one pose; it is drawn and nothing else.
std::vector<ColouredPath> paths_to_draw(const LogJob& job, const ReplayResult& result) {
  std::vector<ColouredPath> paths;
  ColouredPath estimate{{}, kEstimateColour};
  for (const StampedPose& stamped : result.trajectory) {
    estimate.poses.push_back(stamped.map_T_scan);
  }
  if (!job.truth.empty()) {
    ColouredPath truth{{}, kTruthColour};
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

void write_replay(const LogJob& job, const ReplayResult& result, nlohmann::ordered_json summary) {
  write_trajectory(job.out / "trajectory.tum", result.trajectory);
  write_trajectory(job.out / "trajectory_online.tum", result.online_trajectory);
  write_matches(job.out / "matches.csv", result.matches);
  write_map(job.out, result.map);
  write_map_picture(job.out / "map.png", result.map, paths_to_draw(job, result));
  summary["retried_matches"] = result.retried_matches;
  summary["filter_updates"] = result.filter_updates;
  summary["lost_scans"] = result.lost_scans;
  summary["relocalisations"] = result.relocalisations;
  summary["least_fit"] = result.least_fit;
  summary["scan_mean_us_by_tenth"] = mean_by_tenth(result.scan_cpu_us);
  summary["rss_bytes_by_tenth"] = result.rss_bytes_by_tenth;
  summary["sha256"] = sha256_of_file(job.out / "trajectory.tum");
  write_summary(job, summary);
}

void run_replay(const LogJob& job) {
  const RobotParams params = load(job.config);
  if (!job.truth.empty()) {
    static_cast<void>(read_reference_poses(job.truth));  // what is wrong with it is better said before the work
  }
  const ResourceMeter meter;
  const ScanLog log = read_log(job);
  make_output_folder(job.out);
  const std::int64_t scans = scans_used(log, job.options.every);
  ReplayResult result;
  {
    Progress bar(scans);
    result = replay(log, params, job.options, show_on(bar));
  }
  const nlohmann::ordered_json summary = summarise(result.matches, scans, result.log_duration_s, meter);
  write_replay(job, result, summary);
  fmt::print("{} scans in {:.1f} s, {:.1f} times as fast as recorded; {} poor matches; map in {}\n", scans,
             summary["wall_s"].get<double>(), summary["realtime_factor"].get<double>(), result.poor_matches,
             (job.out / "map.png").string());
}

void run_match(const LogJob& job) {
  const RobotParams params = load(job.config);
  const ResourceMeter meter;
  const ScanLog log = read_log(job);
  make_output_folder(job.out);
  const std::int64_t scans = scans_used(log, job.options.every);
  std::vector<MatchRow> rows;
  {
    Progress bar(scans - 1);
    rows = match_pairs(log, params, job.options, show_on(bar));
  }
  write_matches(job.out / "matches.csv", rows);
  const double duration_s = rows.empty() ? 0.0 : rows.back().stamp_s - rows.front().reference_stamp_s;
  const nlohmann::ordered_json summary = summarise(rows, scans, duration_s, meter);
  write_summary(job, summary);
  fmt::print("{} matches, median {:.0f} us, worst {:.0f} us; {} poor; {}\n", rows.size(),
             summary["match_median_us"].get<double>(), summary["match_max_us"].get<double>(),
             summary["poor_matches"].get<int>(), (job.out / "matches.csv").string());
}

CLI::App* add_log_job(CLI::App& app, const char* name, const char* what, LogJob& job) {
  CLI::App* const command = app.add_subcommand(name, what);
  command->add_option("LOG", job.log, "Recorded log (see `odoless info`); .gz and .xz are read too")->required();
  command->add_option("--out", job.out, "Folder for the results")->required();
  command->add_option("--config", job.config, "TOML file that overrides defaults (see `odoless config defaults`)");
  command->add_option("--every", job.options.every, "Use every N-th scan")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", job.options.seed, "Seed of the random generator")->capture_default_str();
  command->add_option("--period-ms", job.period_ms, "Time between scans of a log without stamps")
      ->check(CLI::Range(0.001, 1e6))
      ->capture_default_str();
  return command;
}

}  // namespace

void add_replay(CLI::App& app) {
  const auto job = std::make_shared<LogJob>();
  CLI::App* const command = add_log_job(app, "replay", "Map a recorded log with the laser alone", *job);
  command->add_option("--truth", job->truth, "True poses, only drawn into the picture: TUM, `stamp x y yaw`, or a log");
  command->callback([job] { run_replay(*job); });
}

void add_match(CLI::App& app) {
  const auto job = std::make_shared<LogJob>();
  CLI::App* const command = add_log_job(app, "match", "Match each scan with the one before, nothing else", *job);
  command->callback([job] { run_match(*job); });
}

void add_config(CLI::App& app) {
  CLI::App* const config = app.add_subcommand("config", "What a configuration file can say");
  config->require_subcommand(1);
  config->add_subcommand("reference", "Every key with its default, range and meaning, as Markdown")->callback([] {
    fmt::print("{}", write_reference(DaemonParams{}));
  });
  const auto preset = std::make_shared<std::string>("default");
  CLI::App* const defaults = config->add_subcommand("defaults", "A configuration file that says what is built in");
  defaults->add_option("--preset", *preset, "default, or seed: plain Differential Evolution with N = 100 and G = 50")
      ->check(CLI::IsMember({"default", "seed"}))
      ->capture_default_str();
  defaults->callback([preset] {
    DaemonParams params;
    if (*preset == "seed") {
      params.robot.matcher = seed_matcher_params();
    }
    fmt::print("{}", write_toml(params));
  });
}

}  // namespace odoless
