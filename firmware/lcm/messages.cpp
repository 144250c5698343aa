#include "firmware/lcm/messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"
#include "firmware/records/robot_pose.hpp"

namespace odoless {
namespace {

std::int64_t utime(std::int64_t stamp_ns) { return stamp_ns / 1000; }

void to_array(const Pose2& pose, double (&out)[3]) {
  out[0] = pose.x_m;
  out[1] = pose.y_m;
  out[2] = pose.yaw_rad;
}

template <std::size_t kSize>
void to_array(const std::array<double, kSize>& values, double (&out)[kSize]) {
  std::copy(values.begin(), values.end(), std::begin(out));
}

void to_message(const MotionHypothesis& hypothesis, motion_hypothesis_t& message) {
  to_array(hypothesis.previous_T_current, message.step);
  message.log_weight = hypothesis.log_weight;
  to_array(hypothesis.covariance, message.covariance);
}

// Rotation about z as w, x, y, z.
void to_quaternion(double yaw_rad, double (&out)[4]) {
  out[0] = math::cos(yaw_rad / 2.0);
  out[1] = 0.0;
  out[2] = 0.0;
  out[3] = math::sin(yaw_rad / 2.0);
}

bool is_return(float range_m) { return std::isfinite(range_m) && range_m > 0.0F; }

void to_message(const SourceHealth& source, source_health_t& message) {
  message.age_s = source.age_s;
  message.rate_hz = source.rate_hz;
  message.accepted = source.accepted;
  message.rejected = source.rejected + source.motions_refused + source.forged + source.replayed;
  message.late = source.late;
  message.duplicate = source.duplicate;
  message.out_of_order = source.out_of_order;
  message.resyncs = source.resyncs;
  message.dropped = source.dropped;
  message.reconnects = source.reconnects;
  message.datagrams_lost = source.datagrams_lost;
}

void to_message(const StageHealth& stage, stage_health_t& message) {
  message.scans = stage.scans;
  message.p50_ms = stage.p50_ms;
  message.p99_ms = stage.p99_ms;
  message.max_ms = stage.max_ms;
  message.deadline_misses = stage.deadline_misses;
}

std::int16_t status_type(LrfDriver laser) {
  switch (laser) {
    case LrfDriver::kScip:
      return bot_core::sensor_status_t::HOKUYO_LASER;
    case LrfDriver::kSick:
    case LrfDriver::kSopas:
      return bot_core::sensor_status_t::SICK_LASER;
    case LrfDriver::kRplidar:
    case LrfDriver::kLdrobot:
    case LrfDriver::kYdlidar:
    case LrfDriver::kCsv:
    case LrfDriver::kLcm:
      break;
  }
  return -1;
}

}  // namespace

Velocity velocity_of(const Motion& motion, double map_yaw_rad) {
  const Velocity2 velocity = motion.velocity();
  const Point2 map_mps = Pose2{0.0, 0.0, map_yaw_rad} * Point2{velocity.x_mps, velocity.y_mps};
  return {map_mps.x_m, map_mps.y_m, velocity.yaw_radps};
}

void to_message(const ScanRecord& scan, std::span<const float> ranges_m, bot_core::planar_lidar_t& message) {
  message.utime = utime(scan.stamp_ns);
  message.nranges = static_cast<std::int32_t>(ranges_m.size());
  message.ranges.assign(ranges_m.begin(), ranges_m.end());
  message.nintensities = 0;
  message.rad0 = static_cast<float>(scan.start_angle_rad);
  message.radstep = static_cast<float>(scan.angle_step_rad);
}

void to_message(const ScanRecord& scan, scan_times_t& message) {
  message.utime = utime(scan.stamp_ns);
  message.first_beam_ns = 0;
  message.beam_period_ns = scan.beam_period_ns;
}

void to_message(const RawBytesRecord& raw, std::span<const std::byte> bytes, bot_core::raw_t& message) {
  message.utime = utime(raw.stamp_ns);
  message.length = static_cast<std::int32_t>(bytes.size());
  message.data.resize(bytes.size());
  std::transform(bytes.begin(), bytes.end(), message.data.begin(),
                 [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
}

void to_message(const TiltRecord& tilt, bot_core::joint_state_t& message) {
  message.utime = utime(tilt.stamp_ns);
  message.num_joints = 1;
  message.joint_name.assign(1, "tilt");
  message.joint_position.assign(1, static_cast<float>(tilt.angle_rad));
  message.joint_velocity.assign(1, static_cast<float>(tilt.velocity_radps));
  message.joint_effort.assign(1, 0.0F);
}

void to_message(const Motion& motion, motion_t& message) {
  message.utime = utime(motion.to_stamp_ns);
  message.reference_utime = utime(motion.from_stamp_ns);
  message.duration_ns = motion.duration_ns;
  message.duration_sd = motion.duration_sd_s;
  to_array(motion.previous_T_current, message.step);
  to_array(motion.odom_T_current, message.pose);
  to_array(rows_of<3>(motion.covariance_with_slip()), message.covariance);
  to_array(motion.error_initial, message.error_initial);
  to_array(motion.error_transition, message.error_transition);
  to_array(motion.error_noise, message.error_noise);
  message.fitness = motion.fitness;
  message.score = motion.score;
  message.second_peak_ratio = motion.second_peak_ratio;
  message.information[0] = motion.strong_information_1_m2;
  message.information[1] = motion.weak_information_1_m2;
  message.evaluations = motion.evaluations;
  message.steps = motion.steps;
  message.flags = static_cast<std::int32_t>(motion.flags);
  message.probability = motion.probability;
  message.log_weight = motion.log_weight;
  message.alternative_count = motion.alternative_count;
  message.alternatives.resize(motion.others().size());
  for (std::size_t i = 0; i < message.alternatives.size(); ++i) {
    to_message(motion.alternatives[i], message.alternatives[i]);
  }
}

void to_message(const PoseRecord& pose, pose_estimate_t& message) {
  const RobotPose robot = robot_pose_of(pose);
  message.utime = utime(pose.stamp_ns);
  message.update_utime = utime(pose.update_stamp_ns);
  to_array(robot.map_T_robot, message.pose);
  to_array(robot.update_T_robot, message.step);
  to_array(robot.covariance, message.covariance);
  message.log_likelihood_per_beam = pose.log_likelihood_per_beam;
  message.particles = pose.particles;
  message.effective_particles = pose.effective_particles;
  message.updated = static_cast<std::int8_t>(pose.updated);
}

void to_message(const PoseRecord& pose, const Velocity& velocity, bot_core::pose_t& message) {
  const Pose2 map_T_robot = robot_pose_of(pose).map_T_robot;
  message = {};
  message.utime = utime(pose.stamp_ns);
  message.pos[0] = map_T_robot.x_m;
  message.pos[1] = map_T_robot.y_m;
  message.vel[0] = velocity.x_mps - velocity.yaw_radps * (map_T_robot.y_m - pose.map_T_scan.y_m);
  message.vel[1] = velocity.y_mps + velocity.yaw_radps * (map_T_robot.x_m - pose.map_T_scan.x_m);
  to_quaternion(map_T_robot.yaw_rad, message.orientation);
  message.rotation_rate[2] = velocity.yaw_radps;
}

void to_laser_message(const PoseRecord& pose, const Velocity& velocity, bot_core::pose_t& message) {
  message = {};
  message.utime = utime(pose.stamp_ns);
  message.pos[0] = pose.map_T_scan.x_m;
  message.pos[1] = pose.map_T_scan.y_m;
  message.vel[0] = velocity.x_mps;
  message.vel[1] = velocity.y_mps;
  to_quaternion(pose.map_T_scan.yaw_rad + pose.laser.yaw_rad, message.orientation);
  if (pose.laser.is_flipped) {  // half a turn about its own x axis, before that
    std::swap(message.orientation[0], message.orientation[1]);
    std::swap(message.orientation[3], message.orientation[2]);
  }
  message.rotation_rate[2] = velocity.yaw_radps;
}

void to_message(const PoseRecord& pose, bot_core::rigid_transform_t& message) {
  message.utime = utime(pose.stamp_ns);
  message.trans[0] = pose.map_T_odom.x_m;
  message.trans[1] = pose.map_T_odom.y_m;
  message.trans[2] = 0.0;
  to_quaternion(pose.map_T_odom.yaw_rad, message.quat);
}

void to_message(const MapCorrection& correction, correction_t& message) {
  message.utime = utime(correction.stamp_ns);
  message.cause = static_cast<std::int8_t>(correction.cause);
  message.older_submap = correction.reference;
  message.newer_submap = correction.query;
  message.loop_closures = correction.loop_closures;
  to_array(correction.moved, message.moved);
}

void to_message(const MapTileRecord& tile, std::int32_t sequence, map_tile_t& message) {
  message.utime = utime(tile.stamp_ns);
  message.sequence = sequence;
  message.column = tile.column;
  message.row = tile.row;
  message.size_cells = tile.size_cells;
  message.cell_size_m = tile.cell_size_m;
}

void to_message(const HealthReport& health, health_t& message) {
  message.utime = utime(health.stamp_ns);
  message.state = static_cast<std::int8_t>(health.state);
  message.reasons = static_cast<std::int32_t>(health.reasons);
  message.latched_reasons = static_cast<std::int32_t>(health.latched_reasons);
  to_message(health.lrf, message.lrf);
  message.fitness = health.fitness;
  message.second_peak_ratio = health.second_peak_ratio;
  std::copy(health.information_1_m2.begin(), health.information_1_m2.end(), std::begin(message.information));
  message.evaluations = health.evaluations;
  message.deadline_hit = static_cast<std::int8_t>(health.deadline_hit);
  message.effective_particles = health.effective_particles;
  message.particles = health.particles;
  message.position_sd_m = health.position_sd_m;
  message.yaw_sd_rad = health.yaw_sd_rad;
  message.pose_probability = health.pose_probability;
  for (std::size_t stage = 0; stage < health.stages.size(); ++stage) {
    to_message(health.stages[stage], message.stages[stage]);
  }
  message.page_faults = health.page_faults;
  message.allocations = health.allocations;
  message.scan_queue_high_water = health.scan_queue_high_water;
  message.motion_queue_high_water = health.motion_queue_high_water;
  message.map_pool_used = health.map_pool_used;
  message.records_dropped = health.records_dropped;
  message.publish_errors = health.publish_errors;
  message.checkpoint_age_s = health.checkpoint_age_s;
  message.storage_error = health.storage_error;
}

void to_message(const WorldHealth& world, const HealthReport& health, world_t& message) {
  message.utime = utime(health.stamp_ns);
  message.uuid = world.uuid;
  message.revision = world.revision;
  message.read_only = world.is_read_only ? 1 : 0;
  message.place = static_cast<std::int8_t>(health.graph ? health.graph->place : WorldPlaceKnown::kNo);
}

void to_message(const CloudHealth& cloud, std::int64_t stamp_ns, cloud_health_t& message) {
  message.utime = utime(stamp_ns);
  message.points = cloud.points;
  message.used = cloud.used;
  message.refused = cloud.refused;
  message.scans_left_out = cloud.scans_left_out;
}

void to_message(const HealthReport& health, LrfDriver laser, bot_core::sensor_status_t& message) {
  message.utime = utime(health.stamp_ns);
  message.sensor_name = "lrf";
  message.rate = health.lrf.rate_hz;
  message.type = status_type(laser);
}

void to_points(const PoseRecord& pose, const ScanRecord& scan, std::span<const float> ranges_m,
               bot_core::pointcloud_t& message) {
  const auto returns = static_cast<int>(std::count_if(ranges_m.begin(), ranges_m.end(), is_return));
  const int stride = std::max(1, (returns + kPointsMax - 1) / kPointsMax);
  message.utime = utime(scan.stamp_ns);
  ++message.seq;
  message.frame_id = "map";
  message.n_channels = 0;
  message.n_points = 0;
  int seen = 0;
  for (std::size_t beam = 0; beam < ranges_m.size(); ++beam) {
    if (!is_return(ranges_m[beam]) || seen++ % stride != 0) {
      continue;
    }
    const double angle_rad =
        pose.laser.bearing_rad(scan.start_angle_rad + static_cast<double>(beam) * scan.angle_step_rad);
    const double range_m = ranges_m[beam];
    const Point2 p_map = pose.map_T_scan * Point2{range_m * math::cos(angle_rad), range_m * math::sin(angle_rad)};
    auto& point = message.points[static_cast<std::size_t>(message.n_points++)];
    point[0] = static_cast<float>(p_map.x_m);
    point[1] = static_cast<float>(p_map.y_m);
    point[2] = 0.0F;
  }
}

void reserve_cloud(bot_core::pointcloud_t& message) {
  message.points.assign(kCloudPointsMax, std::vector<float>(3));
  message.channel_names = {"key", "edition"};
  message.n_channels = 2;
  message.channels.assign(2, std::vector<float>(kCloudPointsMax));
  message.frame_id = "map";
  message.seq = -1;
}

void to_message(const CloudPiece& piece, bot_core::pointcloud_t& message) {
  ODOLESS_CHECK(piece.points.size() <= static_cast<std::size_t>(kCloudPointsMax));
  message.utime = utime(piece.stamp_ns);
  ++message.seq;
  message.n_points = static_cast<std::int32_t>(piece.points.size());
  const Pose3 map_T_key = Pose3::of(piece.map_T_key);
  for (std::size_t i = 0; i < piece.points.size(); ++i) {
    const Point3 p_map = map_T_key * Point3{piece.points[i].x_m, piece.points[i].y_m, piece.points[i].z_m};
    message.points[i][0] = static_cast<float>(p_map.x_m);
    message.points[i][1] = static_cast<float>(p_map.y_m);
    message.points[i][2] = static_cast<float>(p_map.z_m);
    message.channels[0][i] = static_cast<float>(piece.key);
    message.channels[1][i] = static_cast<float>(piece.edition);
  }
}

}  // namespace odoless
