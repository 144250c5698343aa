#include "tools/cloud/cloud_job.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/scan/laser_mount.hpp"
#include "tools/cloud/merged_cloud.hpp"
#include "tools/command/error.hpp"
#include "tools/eval/ate.hpp"
#include "tools/log/plausibility.hpp"
#include "tools/output/cloud_files.hpp"
#include "tools/output/cloud_picture.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

double to_s(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) * 1e-9; }
double to_deg(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }

/// What there is to be mapped; with the truth where it is simulated.
struct Input {
  TiltLog log;
  World world;
  std::vector<StampedPose> truth;
  std::vector<std::string> corrected;  ///< in the log
};

/// Makes a log's scans plausible. @throws DataError
std::vector<std::string> correct(const std::string& name, TiltLog& log) {
  ScanLog scans{.format = "tilt CSV", .has_stamps = true, .scans = std::move(log.scans)};
  const Plausibility plausibility = make_plausible(scans);
  if (!plausibility.is_plausible()) {
    throw DataError(name, 0, plausibility.wrong, plausibility.right);
  }
  log.scans = std::move(scans.scans);
  return plausibility.corrected;
}

Input read_whole_input(const CloudJob& job) {
  Input input;
  if (std::filesystem::path(job.input).extension() != ".world") {
    input.log = read_tilt_log(job.input);
    input.corrected = correct(job.input, input.log);
    return input;
  }
  input.world = slowed(read_world(job.input), job.speed_max_mps);
  const TiltMount mount(job.true_mount.value_or(job.params.mapping.mount));
  TiltedSimulation simulation = simulate_tilted(input.world, mount, job.lrf, job.tilt, job.seed);
  input.log = std::move(simulation.log);
  input.truth = std::move(simulation.truth);
  if (job.write_log) {
    write_whole_file(job.out / "tilt_log.csv", tilt_csv(input.log, input.log.row_offset_ns));
  }
  return input;
}

Input read_input(const CloudJob& job) {
  Input input = read_whole_input(job);
  const auto scans_max = static_cast<std::size_t>(job.scans_max);
  if (scans_max > 0 && input.log.scans.size() > scans_max) {
    input.log.scans.resize(scans_max);
    input.truth.resize(std::min(input.truth.size(), scans_max));
  }
  return input;
}

/// Scans as they are mounted, in place of those that the laser says.
void mount_scans(TiltLog& log, const RobotParams& params) {
  LaserMount mount(params.mount, params.scan.beams_max);
  for (LogScan& scan : log.scans) {
    const RawScan mounted = mount.apply(scan.raw());
    scan.start_angle_rad = mounted.start_angle_rad;
    scan.first_beam_ns = mounted.first_beam_ns;
    scan.beam_period_ns = mounted.beam_period_ns;
    scan.ranges_m = std::vector<float>(mounted.ranges_m.begin(), mounted.ranges_m.end());
  }
}

std::vector<ReferencePose> reference_of(const std::vector<StampedPose>& poses) {
  std::vector<ReferencePose> out;
  for (const StampedPose& pose : poses) {
    out.push_back({to_s(pose.stamp_ns), pose.map_T_scan});
  }
  return out;
}

CloudTruth compare(const Input& input, const CloudResult& result) {
  const AteResult ate = evaluate_ate(reference_of(input.truth), reference_of(result.run.slam.trajectory), {});
  const Pose3 world_T_map = Pose3::of(ate.reference_T_estimate);
  std::vector<double> distances_m;
  for (const Point3& p_map : result.points) {
    distances_m.push_back(distance_m(input.world.building, world_T_map * p_map));
  }
  const Statistics distance = summarise(distances_m);
  return {std::move(distances_m), distance, ate.errors.translation_m};
}

/// Level scans come when the servo lets them: gaps between them, and their times, say nothing.
Verdict judge(const CloudRun& run, RunFigures& figures) {
  constexpr double kWithout_pose_max = 0.25;
  figures.missing_s = 0.0;
  figures.untimed = 0;
  Verdict verdict = odoless::judge(figures);
  const int all = run.scans_in_cloud + run.scans_without_pose;
  if (run.scans_without_pose > kWithout_pose_max * all) {
    verdict.grade = std::max(verdict.grade, Grade::kDoubtful);
    verdict.reasons.push_back(fmt::format("{} of {} scans have no pose", run.scans_without_pose, all));
  }
  return verdict;
}

nlohmann::ordered_json to_json(const Statistics& statistics, double unit) {
  return {{"count", statistics.count},
          {"median", statistics.median * unit},
          {"mean", statistics.mean * unit},
          {"percentile_95", statistics.percentile_95 * unit},
          {"max", statistics.max * unit}};
}

nlohmann::ordered_json summary_of(const CloudResult& result) {
  const CloudRun& run = result.run;
  const KeyedCloud& cloud = run.mapper.cloud();
  nlohmann::ordered_json summary = {{"scans_in_cloud", run.scans_in_cloud},
                                    {"scans_without_pose", run.scans_without_pose},
                                    {"level_scans", run.level_scans},
                                    {"keys", cloud.keys().size()},
                                    {"points_kept", cloud.size()},
                                    {"points_refused", cloud.refused()},
                                    {"points_written", result.points.size()},
                                    {"cloud_cpu_s", run.cloud_cpu_s},
                                    {"servo_clock_ahead_s", to_s(result.clock.clock_ahead_ns)},
                                    {"servo_clock_is_estimated", result.clock_is_estimated},
                                    {"servo_clock_is_told_by_cloud", result.clock.is_told},
                                    {"voxels_per_return", result.clock.voxels_per_return},
                                    {"voxels_per_return_before", result.clock.voxels_per_return_before},
                                    {"floor_height_m", result.check.floor_height_m},
                                    {"floor_deviation_m", to_json(result.check.floor_deviation_m, 1.0)},
                                    {"wall_lean_deg", to_json(result.check.wall_lean_rad, to_deg(1.0))},
                                    {"saw_floor_and_walls", result.check.saw_enough()},
                                    {"calibration_is_straight", result.check.is_straight()}};
  if (result.truth) {
    summary["distance_to_truth_m"] = to_json(result.truth->distance_m, 1.0);
    summary["pose_error_m"] = to_json(result.truth->pose_error_m, 1.0);
  }
  summary["corrected"] = result.corrected;
  add_verdict(result.figures, result.verdict, summary);
  return summary;
}

}  // namespace

std::vector<Point3> points_of_keys(const KeyedCloud& cloud, std::size_t keys) {
  std::vector<Point3> points;
  for_each_point(cloud, [&](std::size_t key, const Point3& p_map, std::uint32_t) {
    if (key < keys) {
      points.push_back(p_map);
    }
  });
  return points;
}

CloudResult run_cloud_job(const CloudJob& job, const ReplayProgress& progress) {
  Input input = read_input(job);
  mount_scans(input.log, job.params.robot);
  CloudSetup setup{job.servo, job.params.mapping, job.params.robot, job.seed};
  setup.robot.mount = {};
  setup.servo.clock_ahead_ns = job.clock_ahead_s ? std::llround(*job.clock_ahead_s * 1e9) : input.log.row_offset_ns;
  CloudResult result{.run = make_cloud(input.log, setup, progress)};
  result.clock.clock_ahead_ns = setup.servo.clock_ahead_ns;
  result.clock_is_estimated = !job.clock_ahead_s;
  if (result.clock_is_estimated) {
    result.clock = align_clocks(input.log, setup, result.run.slam);
  }
  if (result.clock.clock_ahead_ns != setup.servo.clock_ahead_ns) {
    setup.servo.clock_ahead_ns = result.clock.clock_ahead_ns;
    result.run = make_cloud(input.log, setup, progress);
  }
  result.corrected = std::move(input.corrected);
  result.figures = figures_of(result.run.slam);
  result.verdict = judge(result.run, result.figures);
  result.points = merged_cloud(result.run.mapper.cloud(), setup.mapping.cloud.voxel_m);
  if (result.points.empty()) {
    throw DataError(job.input, 0, "no point was mapped", "scans with returns while the laser's pose is known");
  }
  result.check = check_cloud(result.run.mapper.cloud());
  if (!input.truth.empty()) {
    result.truth = compare(input, result);
  }
  return result;
}

void write_cloud_result(const CloudJob& job, const CloudResult& result) {
  const HeightColours colours(result.points);
  const double cut_m = below_ceiling_m(colours);
  write_cloud_ply(job.out / "cloud.ply", result.points, colours);
  write_cloud_pcd(job.out / "cloud.pcd", result.points, colours);
  write_drawing(job.out / "cloud_top.png", draw_cloud_from_above(result.points, colours, cut_m));
  write_drawing(job.out / "cloud_perspective.png",
                draw_cloud_with_heights(result.points, colours, cut_m, "3D map without the ceiling"));
  if (job.keys_shown > 0) {
    const std::vector<Point3> shown =
        points_of_keys(result.run.mapper.cloud(), static_cast<std::size_t>(job.keys_shown));
    write_drawing(
        job.out / "cloud_keys.png",
        draw_cloud_with_heights(shown, colours, cut_m, fmt::format("The first {} key poses", job.keys_shown)));
  }
  write_trajectory(job.out / "trajectory.tum",
                   robot_trajectory(result.run.slam.trajectory, LaserPlace::of(job.params.robot.mount)));
  write_whole_file(job.out / "summary.json", summary_of(result).dump(2) + "\n");
}

}  // namespace odoless
