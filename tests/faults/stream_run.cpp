#include "tests/faults/stream_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/tools/sim_support.hpp"
#include "tools/fault_campaign/judge.hpp"
#include "tools/fault_campaign/watched_chain.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::test {
namespace {

using campaign::ScanStream;
using campaign::SentScan;

constexpr double kTick_s = 0.01;  // how often the daemon says how it is, at least

ScanStream clean_stream_of(const FaultyDrive& drive, const Path& path) {
  SimulatedLrf lrf(drive.laser, drive.seed);
  ScanStream stream{.start_angle_rad = lrf.start_angle_rad(), .angle_step_rad = lrf.angle_step_rad()};
  const int count = static_cast<int>(drive.duration_s * drive.laser.rate_hz);
  for (int i = 0; i < count; ++i) {
    const double true_s = i / drive.laser.rate_hz;
    const std::span<const double> ranges_m = lrf.sweep(drive.world, path, true_s);
    const std::int64_t time_ns = campaign::host_ns(true_s);
    stream.scans.push_back({true_s, time_ns, time_ns, {ranges_m.begin(), ranges_m.end()}});
  }
  return stream;
}

/// The daemon on such a stream, and what it says.
class Watcher {
 public:
  Watcher(const FaultyDrive& drive, const Path& path)
      : drive_(drive), path_(path), chain_(RobotParams{}, drive.seed, true) {}

  void take(const ScanStream& stream, const SentScan& scan) {
    const Pose2 before = chain_.last().filter.map_T_scan;
    if (chain_.process(stream.raw(scan), scan.arrival_ns) == ScanVerdict::kAccepted) {
      const Pose2& pose = chain_.last().filter.map_T_scan;
      last_true_s_ = scan.true_s;
      const double time_s = campaign::since_start_s(scan.arrival_ns);
      if (lasts(time_s)) {
        run_.largest_step_m = std::max(run_.largest_step_m, (before.inverse() * pose).distance_m({}));
        run_.maps_made += chain_.last().filter.updated ? 1 : 0;
      }
      run_.is_finite = run_.is_finite && std::isfinite(pose.x_m + pose.y_m + pose.yaw_rad);
      if (time_s >= drive_.from_s) {
        enter_error();
      }
    }
    look(campaign::since_start_s(scan.arrival_ns));
  }

  void look(double time_s) {
    const HealthReport& report = chain_.health(campaign::host_ns(time_s));
    const bool is_ok = report.state == HealthState::kOk;
    if (lasts(time_s)) {
      run_.reasons |= report.reasons;
      ++looks_;
      not_ok_ += is_ok ? 0 : 1;
    }
    if (time_s >= drive_.from_s && !is_ok) {
      run_.flag_s = std::min(run_.flag_s, time_s - drive_.from_s);
    }
    const bool is_wrong = chain_.has_pose() && campaign::is_wrong(off());
    wrong_since_s_ = is_ok && is_wrong ? std::min(wrong_since_s_, time_s) : FaultyRun::kNever_s;
    run_.wrong_and_ok_s = std::max(run_.wrong_and_ok_s, time_s - wrong_since_s_);
    watch_recovery(time_s, is_ok && !is_wrong);
  }

  [[nodiscard]] FaultyRun result(double time_s) {
    run_.rms_m = std::sqrt(sum_m2_ / std::max(1, errors_));
    run_.rms_yaw_rad = std::sqrt(sum_rad2_ / std::max(1, errors_));
    run_.final_off = off();
    run_.final_error_m = off().distance_m({});
    run_.final_error_rad = std::abs(off().yaw_rad);
    run_.not_ok_share = not_ok_ / std::max(1.0, looks_);
    run_.last = chain_.health(campaign::host_ns(time_s));
    return run_;
  }

 private:
  [[nodiscard]] bool lasts(double time_s) const { return time_s >= drive_.from_s && time_s < drive_.until_s; }

  [[nodiscard]] Pose2 off() const {
    const Pose2 start_T_true = path_.at(0.0).inverse() * path_.at(last_true_s_);
    return start_T_true.inverse() * chain_.last().filter.map_T_scan;
  }

  void enter_error() {
    ++errors_;
    sum_m2_ += std::pow(off().distance_m({}), 2.0);
    sum_rad2_ += std::pow(off().yaw_rad, 2.0);
  }

  void watch_recovery(double time_s, bool is_good) {
    constexpr double kFor_s = 1.0;
    if (time_s < drive_.until_s || std::isfinite(run_.recover_s)) {
      return;
    }
    good_since_s_ = is_good ? std::min(good_since_s_, time_s) : FaultyRun::kNever_s;
    if (time_s - good_since_s_ >= kFor_s) {
      run_.recover_s = good_since_s_ - drive_.until_s;
    }
  }

  const FaultyDrive& drive_;
  const Path& path_;
  campaign::WatchedChain chain_;
  FaultyRun run_;
  double last_true_s_ = 0.0;
  double wrong_since_s_ = FaultyRun::kNever_s;
  double good_since_s_ = FaultyRun::kNever_s;
  double sum_m2_ = 0.0;
  double sum_rad2_ = 0.0;
  double looks_ = 0.0;
  double not_ok_ = 0.0;
  int errors_ = 0;
};

}  // namespace

FaultyDrive drive_of(const std::string& world) {
  FaultyDrive drive{.world = read_world(example_world(world))};
  drive.laser = {
      .field_of_view_rad = 270.0 * kRadPerDeg, .beams = 271, .rate_hz = 10.0, .range_max_m = 30.0, .noise_sd_m = 0.01};
  for (Waypoint& waypoint : drive.world.waypoints) {
    constexpr double kFastest_mps = 0.5;
    waypoint.speed_mps = std::min(waypoint.speed_mps, kFastest_mps);
  }
  return drive;
}

double period_s(const FaultyDrive& drive) { return 1.0 / drive.laser.rate_hz; }

FaultyRun play(const FaultyDrive& drive) {
  const Path path(drive.world.waypoints);
  ScanStream stream = clean_stream_of(drive, path);
  if (drive.spoil) {
    drive.spoil(stream);
  }
  Watcher watcher(drive, path);
  std::size_t next = 0;
  double time_s = 0.0;
  for (int tick = 1; time_s < drive.duration_s; time_s = kTick_s * tick++) {
    for (; next < stream.scans.size() && stream.scans[next].arrival_ns <= campaign::host_ns(time_s); ++next) {
      watcher.take(stream, stream.scans[next]);
    }
    watcher.look(time_s);
  }
  return watcher.result(time_s);
}

void for_each_faulty(const FaultyDrive& drive, ScanStream& stream, const std::function<void(SentScan&)>& change) {
  for (SentScan& scan : stream.scans) {
    if (scan.true_s >= drive.from_s && scan.true_s < drive.until_s) {
      change(scan);
    }
  }
}

}  // namespace odoless::test
