#include "tools/command/info.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "config/config.hpp"
#include "core/cloud/tilt_mount.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/health/health_text.hpp"
#include "tools/command/error.hpp"
#include "tools/log/log_info.hpp"
#include "tools/log/plausibility.hpp"
#include "tools/log/tilt_log.hpp"

namespace odoless {
namespace {

struct InfoOptions {
  std::string log;
  std::string topic;
  std::string config;
  bool json = false;
  std::int64_t period_ms = kDefaultPeriodNs / 1'000'000;
};

double to_deg(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }

nlohmann::ordered_json to_json(const LogInfo& info) {
  return {{"format", info.format},
          {"scans", info.scans},
          {"beams_min", info.beams_min},
          {"beams_max", info.beams_max},
          {"angle_min_rad", info.angle_min_rad},
          {"angle_max_rad", info.angle_max_rad},
          {"angle_step_min_rad", info.angle_step_min_rad},
          {"angle_step_max_rad", info.angle_step_max_rad},
          {"has_stamps", info.has_stamps},
          {"stamps_backwards", info.times.out_of_order},
          {"stamps_bunched", info.times.bunched},
          {"gaps", info.times.gaps},
          {"longest_gap_s", info.times.longest_gap_s},
          {"clock_sets", info.times.clock_sets},
          {"doubtful_times", info.times.doubtful},
          {"period_s", info.times.period_s},
          {"sweep_s", info.sweep_s},
          {"duration_s", info.duration_s},
          {"rate_hz", info.rate_hz},
          {"return_share", info.return_share},
          {"no_return_share", info.no_return_share},
          {"invalid_share", info.invalid_share},
          {"range_min_m", info.range_min_m},
          {"range_median_m", info.range_m.median},
          {"range_max_m", info.range_m.max}};
}

template <class Number>
std::string span_text(Number min, Number max, const char* format) {
  const std::string low = fmt::format(fmt::runtime(format), min);
  const std::string high = fmt::format(fmt::runtime(format), max);
  return low == high ? low : fmt::format("{} to {}", low, high);
}

void print_text(const LogInfo& info) {
  fmt::print("format    {}\n", info.format);
  fmt::print("scans     {}\n", info.scans);
  fmt::print("beams     {}\n", span_text(info.beams_min, info.beams_max, "{}"));
  fmt::print("angles    {:.2f} to {:.2f} deg, step {} deg\n", to_deg(info.angle_min_rad), to_deg(info.angle_max_rad),
             span_text(to_deg(info.angle_step_min_rad), to_deg(info.angle_step_max_rad), "{:.4f}"));
  fmt::print("duration  {:.1f} s, {:.2f} scans per second\n", info.duration_s, info.rate_hz);
  fmt::print("stamps    {}\n", info.has_stamps ? times_text(info.times) : "none: index x period");
  fmt::print("sweep     {}\n", info.sweep_s > 0.0 ? fmt::format("{:.1f} ms", 1e3 * info.sweep_s) : kSweepNotTold);
  fmt::print("beams     {:.1f} % returns, {:.1f} % no return, {:.1f} % invalid\n", 100.0 * info.return_share,
             100.0 * info.no_return_share, 100.0 * info.invalid_share);
  fmt::print("ranges    {:.2f} m least, {:.2f} m median, {:.2f} m most\n", info.range_min_m, info.range_m.median,
             info.range_m.max);
}

void print_plausibility(const Plausibility& plausibility) {
  for (const std::string& correction : plausibility.corrected) {
    fmt::print("corrected {}\n", correction);
  }
  if (!plausibility.is_plausible()) {
    fmt::print("wrong     {}; expected {}\n", plausibility.wrong, plausibility.right);
  }
}

void print_mount(const char* name, const MountParams& mount) {
  fmt::print("{:<9} x {:.3f}, y {:.3f}, z {:.3f} m; roll {:.2f}, pitch {:.2f}, yaw {:.2f} deg\n", name, mount.x_m,
             mount.y_m, mount.z_m, to_deg(mount.roll_rad), to_deg(mount.pitch_rad), to_deg(mount.yaw_rad));
}

// The extrinsic calibration, and what follows from it.
void print_geometry(const TiltMountParams& params) {
  const TiltMount mount(params);
  fmt::print("geometry\n");
  print_mount("axis", params.robot_T_tilt);
  print_mount("laser", params.tilt_T_laser);
  fmt::print(
      "level     the laser is {:.3f} m high, {:.3f} m before and {:.3f} m left of the robot's middle, looks "
      "{:.2f} deg to the left\n",
      mount.level_height_m(), mount.robot_T_scan().x_m, mount.robot_T_scan().y_m, to_deg(mount.robot_T_scan().yaw_rad));
}

void print_tilt_log(const TiltLog& log) {
  const auto [lowest, highest] =
      std::minmax_element(log.angles.begin(), log.angles.end(),
                          [](const ServoAngle& a, const ServoAngle& b) { return a.angle_rad < b.angle_rad; });
  const double duration_s = static_cast<double>(log.scans.back().stamp_ns - log.scans.front().stamp_ns) * 1e-9;
  fmt::print("format    tilt CSV\n");
  fmt::print("scans     {} in {:.1f} s; {} rows without one, {} with one that is not new\n", log.scans.size(),
             duration_s, log.empty_rows, log.doubled_scans);
  fmt::print("angles    {}, {:.2f} to {:.2f} deg by the servo\n", log.angles.size(), to_deg(lowest->angle_rad),
             to_deg(highest->angle_rad));
  fmt::print("clocks    the servo's stamps are {:.3f} s after the scans' of the same rows\n",
             static_cast<double>(log.row_offset_ns) * 1e-9);
}

double duration_s(const LogTopic& topic) {
  return static_cast<double>(topic.last_ns) * 1e-9 - static_cast<double>(topic.first_ns) * 1e-9;
}

nlohmann::ordered_json to_json(const std::vector<LogTopic>& topics) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const LogTopic& topic : topics) {
    list.push_back({{"name", topic.name},
                    {"type", topic.type},
                    {"has_scans", topic.has_scans},
                    {"messages", topic.messages},
                    {"duration_s", duration_s(topic)}});
  }
  return list;
}

void print_topics(const std::vector<LogTopic>& topics) {
  for (const LogTopic& topic : topics) {
    fmt::print("topic     {}: {} {} in {:.1f} s{}\n", topic.name, topic.messages, topic.type, duration_s(topic),
               topic.has_scans ? " (scans)" : "");
  }
}

/// Whether scans are there and nobody has said which.
bool is_undecided(const std::vector<LogTopic>& topics, const InfoOptions& options) {
  return options.topic.empty() &&
         std::ranges::count_if(topics, [](const LogTopic& topic) { return topic.has_scans && topic.messages > 0; }) > 1;
}

void print_log(const InfoOptions& options) {
  const std::vector<LogTopic> topics = read_topics(options.log);
  if (topics.empty() && !options.json && is_tilt_log(options.log)) {
    return print_tilt_log(read_tilt_log(options.log));
  }
  nlohmann::ordered_json json;
  if (options.json) {
    json["topics"] = to_json(topics);
  } else {
    print_topics(topics);
  }
  if (is_undecided(topics, options)) {
    fmt::print("{}\n", options.json ? json.dump(2) : "scans     of several topics: --topic NAME tells of one");
    return;
  }
  ScanLog log =
      read_scan_log(options.log, {.default_period_ns = options.period_ms * 1'000'000, .topic = options.topic});
  const Plausibility plausibility = make_plausible(log);
  const LogInfo info = summarise(log, options.log);
  if (options.json) {
    json.update(to_json(info));
    json["corrected"] = plausibility.corrected;
    json["wrong"] = plausibility.wrong;
    fmt::print("{}\n", json.dump(2));
  } else {
    print_text(info);
    print_plausibility(plausibility);
  }
}

void run(const InfoOptions& options) {
  if (!options.config.empty()) {
    DaemonParams params;
    load_parameters(options.config, params);
    print_geometry(params.mapping.mount);
  }
  if (options.log.empty()) {
    if (options.config.empty()) {
      throw UsageError("neither a LOG nor --config was given; expected one of them");
    }
    return;
  }
  print_log(options);
}

}  // namespace

void add_info(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* const command = app.add_subcommand("info", "Print what is in a recorded log");
  command->add_option("LOG", options->log,
                      "Recorded log: CARMEN, DP-SLAM, CSV, LCM, ROS 1 or 2 bag, MCAP, MRPT rawlog, or a tilt log; also "
                      "packed (.gz, .xz, .bz2, .lz4, .zst)");
  command->add_option("--topic", options->topic, "Topic of the scans, where a log of messages has several");
  command->add_option("--config", options->config, "Robot file: print how laser and tilt servo are mounted");
  command->add_option("--period-ms", options->period_ms, "Time between scans of a log without stamps")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Write one JSON object instead of text");
  command->callback([options] { run(*options); });
}

}  // namespace odoless
