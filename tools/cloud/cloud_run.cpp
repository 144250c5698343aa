#include "tools/cloud/cloud_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/stamped_history.hpp"
#include "core/cloud/pose_track.hpp"
#include "core/geometry/interpolated.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/cloud/beam_tilts.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr int kInputIsWrong = 65;

using PoseHistory = StampedHistory<Pose2, BetweenPoses>;

void assign(ScanFrame& frame, const LogScan& scan) {
  const Errc error = frame.assign(scan.raw());
  if (error != Errc::kOk) {
    throw UserError(kInputIsWrong, fmt::format("scan at {:.6f} s: {}; scan.beams_max sets how many beams one may have",
                                               static_cast<double>(scan.stamp_ns) * 1e-9, describe(error)));
  }
}

int level_scans(const ScanLog& log) { return static_cast<int>(std::ranges::count_if(log.scans, &LogScan::is_level)); }

/// All scans, which tell the laser's rhythm, with those marked that are level: each with the ranges that 2D SLAM is
/// given.
ScanLog level_log(const TiltLog& log, const CloudSetup& setup, BeamTilts& tilts) {
  LevelScan level(TiltMount(setup.mapping.mount), setup.mapping.level, setup.robot.scan.beams_max);
  ScanFrame frame(setup.robot.scan);
  ScanLog out{.format = "tilt log", .has_stamps = true, .scans = log.scans};
  for (LogScan& scan : out.scans) {
    assign(frame, scan);
    const Result<std::span<const float>> made = level.make(frame, tilts.of(scan));
    scan.is_level = made.ok();
    if (made.ok()) {
      scan.ranges_m.assign(made.value().begin(), made.value().end());
    }
  }
  if (level_scans(out) < 2) {
    throw UserError(kInputIsWrong,
                    fmt::format("{} of {} scans are level enough for 2D SLAM; expected two or more: are the servo's "
                                "level angle and sense right, and mapping.level.tilt_max_deg?",
                                level_scans(out), log.scans.size()));
  }
  return out;
}

/// The run's poses in three frames, at the level scans' stamps.
struct Track {
  PoseTrack odom_T_scan;
  PoseHistory map_T_odom_online;
  PoseHistory map_T_odom_final;
};

Track track_of(const ReplayResult& slam, const MappingParams& mapping) {
  const std::size_t size = slam.trajectory.size();
  const std::int64_t gap_ns = std::llround(mapping.pose_gap_max_s * 1e9);
  Track track{{size, gap_ns, mapping.yaw_doubt_max_rad}, {size, gap_ns}, {size, gap_ns}};
  Pose2 odom_T_scan;
  for (std::size_t i = 0; i < size; ++i) {
    odom_T_scan = i == 0 ? odom_T_scan : odom_T_scan * slam.matches[i - 1].reference_T_scan;
    const std::int64_t stamp_ns = slam.trajectory[i].stamp_ns;
    const Pose2 scan_T_odom = odom_T_scan.inverse();
    static_cast<void>(track.odom_T_scan.add(stamp_ns, odom_T_scan));
    static_cast<void>(track.map_T_odom_online.add(stamp_ns, slam.online_trajectory[i].map_T_scan * scan_T_odom));
    static_cast<void>(track.map_T_odom_final.add(stamp_ns, slam.trajectory[i].map_T_scan * scan_T_odom));
  }
  return track;
}

CloudRun empty_run(const CloudSetup& setup) {
  return {.mapper = CloudMapper(setup.mapping.cloud, TiltMount(setup.mapping.mount), setup.robot.scan.beams_max),
          .slam = {}};
}

/// Adds every `every`-th scan whose pose is known.
void add_scans(const TiltLog& log, const Track& track, const CloudSetup& setup, std::size_t every, CloudRun& run) {
  BeamTilts tilts(log, setup.servo, setup.mapping.angle_gap_max_s);
  ScanFrame frame(setup.robot.scan);
  for (std::size_t i = 0; i < log.scans.size(); i += every) {
    const LogScan& scan = log.scans[i];
    const std::int64_t first_ns = scan.stamp_ns + scan.first_beam_ns;
    const std::int64_t last_ns = first_ns + scan.beam_period_ns * (static_cast<std::int64_t>(scan.ranges_m.size()) - 1);
    const Result<Pose2> first = track.odom_T_scan.at(first_ns);
    const Result<Pose2> last = track.odom_T_scan.at(last_ns);
    const Result<Pose2> map_T_odom = track.map_T_odom_online.at(scan.stamp_ns);
    if (!first.ok() || !last.ok() || !map_T_odom.ok()) {
      ++run.scans_without_pose;
      continue;
    }
    assign(frame, scan);
    run.mapper.add(frame, tilts.of(scan), {first.value(), last.value()}, map_T_odom.value());
    ++run.scans_in_cloud;
  }
}

void correct_keys(const Track& track, KeyedCloud& cloud) {
  for (std::size_t key = 0; key < cloud.keys().size(); ++key) {
    const std::int64_t stamp_ns = cloud.keys()[key].stamp_ns;
    cloud.correct(key, track.map_T_odom_final.at(stamp_ns).value() * track.odom_T_scan.at(stamp_ns).value());
  }
}

/// How thick the surfaces are that a run's poses and such a clock make.
double voxels_per_return(const TiltLog& log, const Track& track, CloudSetup setup, std::int64_t clock_ahead_ns) {
  constexpr double kVoxelM = 0.1;
  constexpr std::size_t kScans = 400;  // about so many are looked at
  setup.servo.clock_ahead_ns = clock_ahead_ns;
  setup.mapping.cloud.voxel_m = kVoxelM;
  CloudRun run = empty_run(setup);
  add_scans(log, track, setup, log.scans.size() / kScans + 1, run);
  double returns = 0.0;
  for_each_point(run.mapper.cloud(), [&returns](std::size_t, const Point3&, std::uint32_t count) { returns += count; });
  return returns > 0.0 ? static_cast<double>(run.mapper.cloud().size()) / returns : 1.0;
}

}  // namespace

ClockEstimate align_clocks(const TiltLog& log, const CloudSetup& setup, const ReplayResult& slam) {
  struct Search {
    std::int64_t reach_ns;
    std::int64_t step_ns;
  };
  const Track track = track_of(slam, setup.mapping);
  const double before = voxels_per_return(log, track, setup, setup.servo.clock_ahead_ns);
  ClockEstimate best{setup.servo.clock_ahead_ns, before, before, false};
  for (const Search& search : {Search{400'000'000, 20'000'000}, Search{18'000'000, 2'000'000}}) {
    const std::int64_t middle_ns = best.clock_ahead_ns;
    for (std::int64_t off_ns = -search.reach_ns; off_ns <= search.reach_ns; off_ns += search.step_ns) {
      const double voxels = voxels_per_return(log, track, setup, middle_ns + off_ns);
      if (voxels < best.voxels_per_return) {
        best.clock_ahead_ns = middle_ns + off_ns;
        best.voxels_per_return = voxels;
      }
    }
  }
  constexpr double kClearlyThinner = 0.98;
  constexpr std::int64_t kEnd_ns = 380'000'000;
  constexpr std::int64_t kBias_ns = 20'000'000;  // nearer, the rows are the better judge: the search errs by some 6 ms
  const std::int64_t off_ns = std::abs(best.clock_ahead_ns - setup.servo.clock_ahead_ns);
  best.is_told = best.voxels_per_return < kClearlyThinner * before && off_ns < kEnd_ns && off_ns > kBias_ns;
  best.clock_ahead_ns = best.is_told ? best.clock_ahead_ns : setup.servo.clock_ahead_ns;
  return best;
}

CloudRun make_cloud(const TiltLog& log, const CloudSetup& setup, const ReplayProgress& progress) {
  BeamTilts tilts(log, setup.servo, setup.mapping.angle_gap_max_s);
  ScanLog level = level_log(log, setup, tilts);
  CloudRun run = empty_run(setup);
  run.level_scans = level_scans(level);
  run.slam = replay(std::move(level), setup.robot, {.every = 1, .seed = setup.seed}, progress);
  const Track track = track_of(run.slam, setup.mapping);
  const std::int64_t start_ns = thread_cpu_ns();
  add_scans(log, track, setup, 1, run);
  run.cloud_cpu_s = static_cast<double>(thread_cpu_ns() - start_ns) * 1e-9;
  correct_keys(track, run.mapper.cloud());
  return run;
}

}  // namespace odoless
