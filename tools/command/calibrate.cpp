#include "tools/command/calibrate.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "config/config.hpp"
#include "config/expectation.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "tools/calibrate/mount_estimate.hpp"
#include "tools/calibrate/sweep_estimate.hpp"
#include "tools/command/closing.hpp"
#include "tools/command/error.hpp"
#include "tools/log/plausibility.hpp"
#include "tools/output/progress.hpp"
#include "tools/replay/replay.hpp"

namespace odoless {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr const char* kUpsideDown = "upside-down";

/// What both commands are asked.
struct CalibrateJob {
  std::string log;
  std::string topic;
  std::string config;
  double begin_s = 0.0;
  double duration_s = 120.0;
  bool json = false;
};

struct MountJob : CalibrateJob {
  std::string poses;
  std::string first_turn;
  std::string hangs;
};

/// The scans of the time that is asked for; `first` is the index of the first one in the log.
ScanLog part_of(ScanLog log, const CalibrateJob& job, std::size_t& first) {
  const std::int64_t origin_ns = log.scans.front().stamp_ns;
  const auto at = [&](double time_s) {
    return std::ranges::find_if(log.scans, [&, end_ns = origin_ns + std::llround(time_s * 1e9)](const LogScan& scan) {
      return scan.stamp_ns >= end_ns;
    });
  };
  const auto end = at(job.begin_s + job.duration_s);
  const auto begin = std::min(at(job.begin_s), end);
  first = static_cast<std::size_t>(begin - log.scans.begin());
  log.scans = std::vector<LogScan>(begin, end);
  if (log.scans.size() < 2) {
    throw DataError(job.log, 0, fmt::format("{} scans from {} s on", log.scans.size(), job.begin_s),
                    "two or more (--from-s, --for-s)");
  }
  return log;
}

std::vector<MatchRow> match(const ScanLog& log, RobotParams params) {
  params.mount = {};
  Progress bar(static_cast<std::int64_t>(log.scans.size()) - 1, InPipe::kLines);
  return match_pairs(log, params, {},
                     [&bar](std::int64_t done, std::int64_t, double) { bar.update(done, "matching scans"); });
}

/// Poses that belong to the scans, if there are any: of another file, or of the log itself.
std::optional<ReferencePoses> poses_for(const MountJob& job, const ScanLog& log, std::size_t first) {
  if (!job.poses.empty()) {
    return read_reference_poses(job.poses);
  }
  if (!log.format.starts_with("CARMEN")) {
    return std::nullopt;
  }
  ReferencePoses poses = read_reference_poses(job.log);
  poses.poses.erase(poses.poses.begin(),
                    poses.poses.begin() + static_cast<std::ptrdiff_t>(std::min(first, poses.poses.size())));
  return poses;
}

Handedness handedness_of(const MountJob& job, const ScanLog& log, std::size_t first, std::vector<MatchRow> matches) {
  if (!job.first_turn.empty()) {
    return compare_first_turn(std::move(matches), job.first_turn == "left");
  }
  const std::optional<ReferencePoses> poses = poses_for(job, log, first);
  return poses ? compare_turns(std::move(matches), *poses) : Handedness{.matches = std::move(matches)};
}

/// What of the mount follows. How it hangs, the plane does not show; who has not looked is given the simplest.
LaserMountParams mount_of(const MountJob& job, Handedness::Verdict verdict, const LaserMountParams& configured) {
  LaserMountParams mount = configured;
  const bool is_swapped = verdict == Handedness::Verdict::kSwapped;
  mount.upside_down = job.hangs.empty() ? is_swapped : job.hangs == kUpsideDown;
  mount.mirrored = is_swapped != mount.upside_down;
  return mount;
}

std::string case_text(const MountJob& job, Handedness::Verdict verdict) {
  const bool is_swapped = verdict == Handedness::Verdict::kSwapped;
  if (verdict == Handedness::Verdict::kUnknown) {
    return "left and right: cannot be told";
  }
  if (job.hangs.empty()) {
    return is_swapped ? "left and right: swapped. The laser hangs upside down, or it is upright and its bearings are "
                        "mirrored: scans are the same; look at it, and say --hangs upright or upside-down"
                      : "left and right: as they should be. The laser is upright and not mirrored (or both upside down "
                        "and mirrored: scans are the same, and nothing is to be done)";
  }
  const bool is_mirrored = is_swapped != (job.hangs == kUpsideDown);
  return fmt::format("left and right: {}. The laser is {} and {}", is_swapped ? "swapped" : "as they should be",
                     job.hangs == kUpsideDown ? "upside down" : "upright", is_mirrored ? "mirrored" : "not mirrored");
}

std::string evidence_text(const MountJob& job, const Handedness& found) {
  if (job.first_turn.empty() && found.turned_rad == 0.0) {
    return "turns: none is known. A log with odometry (CARMEN) has them, or --poses FILE; else let the robot turn left "
           "by 30 deg or more, and say --first-turn left";
  }
  if (!job.first_turn.empty() && found.turned_rad == 0.0) {
    return "turns: the scans show no turn of 30 deg";
  }
  return fmt::format(
      "turns: {:.0f} deg; scans and what is known of them agree by {:.2f} (1: the same way, -1: the "
      "other way; told from 30 deg and 0.5 on)",
      found.turned_rad * kDegPerRad, found.agreement);
}

std::string own_text(const OwnSectors& own) {
  if (!own.is_told) {
    return fmt::format(
        "robot in view: cannot be told from {:.1f} m and {:.0f} deg of motion; 2 m, or half a turn, "
        "and 10 places are needed",
        own.travel_m, own.turned_rad * kDegPerRad);
  }
  return own.sectors.empty() ? "robot in view: nowhere" : "robot in view: in the sectors that are to be ignored";
}

Entry::Sectors in_degrees(std::span<const AngleSector> sectors) {
  Entry::Sectors out;
  for (const AngleSector& sector : sectors) {
    out.push_back({std::round(sector.from_rad * kDegPerRad), std::round(sector.to_rad * kDegPerRad)});
  }
  return out;
}

void print(const MountJob& job, const Handedness& hand, const OwnSectors& own, const LaserMountParams& mount) {
  const Entry::Sectors ignore = in_degrees(sectors_on(own.sectors, LaserPlace::of(mount)));
  if (job.json) {
    constexpr const char* kVerdicts[] = {"unknown", "right", "swapped"};
    const nlohmann::ordered_json report{{"left_and_right", kVerdicts[static_cast<std::size_t>(hand.verdict)]},
                                        {"turned_deg", hand.turned_rad * kDegPerRad},
                                        {"agreement", hand.agreement},
                                        {"upside_down", mount.upside_down},
                                        {"mirrored", mount.mirrored},
                                        {"robot_in_view_is_told", own.is_told},
                                        {"ignore", ignore}};
    fmt::print("{}\n", report.dump(2));
    return;
  }
  fmt::print("{}\n{}\n{}\n", evidence_text(job, hand), case_text(job, hand.verdict), own_text(own));
  if (hand.verdict != Handedness::Verdict::kUnknown) {
    fmt::print("\n[lrf.mount]\nupside_down = {}\nmirrored = {}\n", mount.upside_down, mount.mirrored);
    if (own.is_told) {
      fmt::print("ignore = {}\n", value_text(ignore));
    }
  }
}

ScanLog read_part(const CalibrateJob& job, std::size_t& first) {
  std::vector<std::string> corrected;
  ScanLog log = part_of(read_plausible_log(job.log, {.topic = job.topic}, corrected), job, first);
  tell_corrections(job.log, corrected);
  return log;
}

DaemonParams params_of(const CalibrateJob& job) {
  DaemonParams params;
  if (!job.config.empty()) {
    load_parameters(job.config, params);
  }
  return params;
}

void run_mount(const MountJob& job) {
  const DaemonParams params = params_of(job);
  std::size_t first = 0;
  const ScanLog log = read_part(job, first);
  const Handedness hand = handedness_of(job, log, first, match(log, params.robot));
  const OwnSectors own = find_own_sectors(log, hand.matches, params.robot.scan);
  print(job, hand, own, mount_of(job, hand.verdict, params.robot.mount));
  if (hand.verdict == Handedness::Verdict::kUnknown) {
    throw DataError(job.log, 0, "how the laser is mounted cannot be told", "turns of 30 deg or more that are known");
  }
}

std::string sweep_text(const SweepEstimate& found) {
  const double sweep_ms = 1e-6 * static_cast<double>(found.sweep_ns);
  switch (found.verdict) {
    case SweepEstimate::Verdict::kSweep:
      return fmt::format("sweep: {:.0f} ms{}: scans in turns match {:.2f} times as well as without", std::abs(sweep_ms),
                         sweep_ms < 0.0 ? ", the last beam first" : "", found.better);
    case SweepEstimate::Verdict::kShort:
      return "sweep: too short to matter";
    case SweepEstimate::Verdict::kUnknown:
      break;
  }
  return "sweep: cannot be told";
}

void print(const CalibrateJob& job, const SweepEstimate& found) {
  const double sweep_ms = std::round(1e-6 * static_cast<double>(found.sweep_ns));
  if (job.json) {
    constexpr const char* kVerdicts[] = {"unknown", "short", "sweep"};
    const nlohmann::ordered_json report{{"verdict", kVerdicts[static_cast<std::size_t>(found.verdict)]},
                                        {"sweep_ms", sweep_ms},
                                        {"period_ms", 1e-6 * static_cast<double>(found.period_ns)},
                                        {"turn_scans", found.turn_scans},
                                        {"better", found.better}};
    fmt::print("{}\n", report.dump(2));
    return;
  }
  fmt::print("turns: {} scans in turns that are fast enough to tell\n{}\n", found.turn_scans, sweep_text(found));
  if (found.verdict != SweepEstimate::Verdict::kUnknown) {
    fmt::print("\n[lrf.mount]\nsweep_ms = {:.0f}\n", sweep_ms);
  }
}

std::string expected_for(const SweepEstimate& found) {
  const double turn_deg = SweepEstimate::kTurn_min_rad * kDegPerRad;
  return found.turn_scans < SweepEstimate::kTurnScans_min
             ? fmt::format("{} or more scans in turns of {:.1f} deg from scan to scan", SweepEstimate::kTurnScans_min,
                           turn_deg)
             : "faster turns; in these a sweep of up to the scans' period makes no difference";
}

void run_sweep(const CalibrateJob& job) {
  const DaemonParams params = params_of(job);
  std::size_t first = 0;
  const ScanLog log = read_part(job, first);
  if (log.scans.front().beam_period_ns != 0) {
    throw DataError(job.log, 0, "its scans tell when each beam was measured, and sweep_ms is not needed",
                    "a log that does not tell it");
  }
  if (!log.has_stamps) {
    throw DataError(job.log, 0, "its scans have no stamps", "a log with them");
  }
  SweepEstimate found;
  {
    std::optional<Progress> bar;
    found = estimate_sweep(log, params.robot, [&bar](int done, int total) {
      (bar ? *bar : bar.emplace(total, InPipe::kLines)).update(done, "laser odometry with other sweeps");
    });
  }
  print(job, found);
  if (found.verdict == SweepEstimate::Verdict::kUnknown) {
    throw DataError(job.log, 0, "how long a sweep takes cannot be told", expected_for(found));
  }
}

/// The options that both commands have.
void add_common(CLI::App& command, CalibrateJob& job) {
  command.add_option("LOG", job.log, "Log of a robot that drives and turns, of any kind that `odoless info` reads")
      ->required();
  command.add_option("--topic", job.topic, "Topic of the scans, where a log of messages has several");
  command.add_option("--config", job.config, "TOML file of the robot: yaw and range limits are taken from it");
  command.add_option("--from-s", job.begin_s, "Begin so long after the first scan")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  command.add_option("--for-s", job.duration_s, "Look at so much of the log")
      ->check(CLI::Range(0.1, 1e9))
      ->capture_default_str();
  command.add_flag("--json", job.json, "Write one JSON object instead of text");
}

void add_sweep(CLI::App& calibrate) {
  const auto job = std::make_shared<CalibrateJob>();
  CLI::App* const sweep = calibrate.add_subcommand(
      "sweep", "How long the laser takes for the beams of one scan, where the log does not tell it");
  add_common(*sweep, *job);
  sweep->callback([job] { run_sweep(*job); });
}

}  // namespace

void add_calibrate(CLI::App& app) {
  CLI::App* const calibrate = app.add_subcommand("calibrate", "What a log tells of how the laser is mounted");
  calibrate->require_subcommand(1);
  add_sweep(*calibrate);
  const auto job = std::make_shared<MountJob>();
  CLI::App* const mount = calibrate->add_subcommand(
      "mount", "Whether left and right are swapped, and in which sectors the laser sees the robot itself");
  add_common(*mount, *job);
  mount->add_option("--first-turn", job->first_turn, "Way of the robot's first turn of 30 deg or more, as you saw it")
      ->check(CLI::IsMember({"left", "right"}));
  mount->add_option("--poses", job->poses, "Poses of the robot at the scans' stamps, instead of those in a CARMEN log");
  mount->add_option("--hangs", job->hangs, "How the laser hangs, as you see it: the scans do not show it")
      ->check(CLI::IsMember({"upright", kUpsideDown}));
  mount->callback([job] { run_mount(*job); });
}

}  // namespace odoless
