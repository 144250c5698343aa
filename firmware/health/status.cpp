#include "firmware/health/status.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/health/health_text.hpp"
#include "firmware/records/robot_pose.hpp"
#include "firmware/world/world_params.hpp"

namespace odoless {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// Standard deviations of a pose.
struct PoseSd {
  double x_m;
  double y_m;
  double yaw_deg;
};

PoseSd sd_of(const RobotPose& pose) {
  return {std::sqrt(pose.covariance[0]), std::sqrt(pose.covariance[4]), std::sqrt(pose.covariance[8]) * kDegPerRad};
}

std::string pose_text(const DaemonStatus& status) {
  if (!status.pose) {
    return "pose: none yet";
  }
  const RobotPose pose = robot_pose_of(*status.pose);
  const Pose2& map_T_robot = pose.map_T_robot;
  const PoseSd sd = sd_of(pose);
  return fmt::format("pose: x {:.2f} m, y {:.2f} m, yaw {:.1f} deg; standard deviations {:.2f} m, {:.2f} m, {:.1f} deg",
                     map_T_robot.x_m, map_T_robot.y_m, map_T_robot.yaw_rad * kDegPerRad, sd.x_m, sd.y_m, sd.yaw_deg);
}

std::string cloud_text(const HealthReport& health) {
  return health.cloud
             ? fmt::format("3D map: {} points, {:.0f} % of its memory; {} returns refused, {} scans left out\n",
                           health.cloud->points, 100.0 * health.cloud->used, health.cloud->refused,
                           health.cloud->scans_left_out)
             : "";
}

constexpr std::array<const char*, 3> kPlaces{"; the robot is not found in the world yet",
                                             "; where the robot is in the world is a guess yet", ""};

std::string graph_text(const HealthReport& health) {
  return health.graph ? fmt::format(
                            "pose graph: {} submaps, {} loop closures, {:.0f} % of its memory; {} keyframes "
                            "left out{}\n",
                            health.graph->submaps, health.graph->loop_closures, 100.0 * health.graph->used,
                            health.graph->keyframes_left_out, kPlaces.at(static_cast<std::size_t>(health.graph->place)))
                      : "";
}

std::string save_text(const SaveStatus& save) {
  switch (save.state) {
    case SaveStatus::State::kSaving:
      return fmt::format("save: under way for {:.1f} s: {}\n", save.since_s, save.doing);
    case SaveStatus::State::kSaved:
      return fmt::format("save: {:.1f} s ago, in {}\n", save.since_s, save.folder);
    case SaveStatus::State::kFailed:
      return fmt::format("save: FAILED {:.1f} s ago: {}\n", save.since_s, save.wrong);
    case SaveStatus::State::kNone:
      break;
  }
  return "";
}

Json save_json(const SaveStatus& save) {
  constexpr std::array<const char*, 4> kStates{"none", "saving", "saved", "failed"};
  return {{"state", kStates.at(static_cast<std::size_t>(save.state))},
          {"since_s", save.since_s},
          {"doing", save.doing},
          {"folder", save.folder},
          {"error", save.wrong}};
}

std::string world_text(const WorldReport& world) {
  const std::string lost =
      world.scans_lost + world.keyframes_lost > 0
          ? fmt::format("; lost: {} keyframes, the poses of {} scans", world.keyframes_lost, world.scans_lost)
          : "";
  if (world.is_read_only) {
    return fmt::format("world: {}, {}, revision {}: it stays as it is, and the robot finds its way in it\n", world.file,
                       world.uuid, world.revision);
  }
  return world.error == 0
             ? fmt::format("world: {}, {}, revision {}, session {}: {} keyframes, written {:.1f} s ago{}\n", world.file,
                           world.uuid, world.revision, world.session, world.keyframes, world.age_s, lost)
             : fmt::format("world: {} cannot be written for {:.0f} s: {}; {} keyframes wait{}\n", world.file,
                           world.age_s, world.reason, world.not_written, lost);
}

Json world_json(const WorldReport& world) {
  return {{"file", world.file},
          {"mode", kWorldUseNames[world.is_read_only ? 1 : 0]},
          {"uuid", world.uuid},
          {"revision", world.revision},
          {"session", world.session},
          {"keyframes", world.keyframes},
          {"keyframes_not_written", world.not_written},
          {"keyframes_lost", world.keyframes_lost},
          {"scans_lost", world.scans_lost},
          {"age_s", world.age_s},
          {"error", world.reason}};
}

Json pose_json(const PoseRecord& pose) {
  const RobotPose robot = robot_pose_of(pose);
  const PoseSd sd = sd_of(robot);
  return {{"stamp_s", static_cast<double>(pose.stamp_ns) * 1e-9},
          {"x_m", robot.map_T_robot.x_m},
          {"y_m", robot.map_T_robot.y_m},
          {"yaw_deg", robot.map_T_robot.yaw_rad * kDegPerRad},
          {"sd_x_m", sd.x_m},
          {"sd_y_m", sd.y_m},
          {"sd_yaw_deg", sd.yaw_deg}};
}

Json stage_json(const StageHealth& stage) {
  return {{"p50_ms", stage.p50_ms},
          {"p99_ms", stage.p99_ms},
          {"max_ms", stage.max_ms},
          {"budget_ms", stage.budget_ms},
          {"deadline_misses", stage.deadline_misses}};
}

Json scans_json(const HealthReport& health) {
  return {
      {"accepted", health.lrf.accepted}, {"rejected", health.lrf.rejected},     {"dropped", health.lrf.dropped},
      {"late", health.lrf.late},         {"not_level", health.scans_not_level}, {"reconnects", health.lrf.reconnects},
      {"age_s", health.lrf.age_s}};
}

}  // namespace

std::string status_text(const DaemonStatus& status) {
  const HealthReport& health = status.health;
  const StageHealth& matcher = health.stages[kMatcherStage];
  const StageHealth& filter = health.stages[kFilterStage];
  return fmt::format(
      "{}\n{}\npose right within 0.5 m and 5 deg: {:.1f} %\n"
      "map: {:.1f} m by {:.1f} m, cells of {:.2f} m, {:.0f} % of its memory\n"
      "scans {} accepted, {} rejected, {} dropped, {} not level, {:.1f} Hz, age {:.3f} s; poses {:.1f} Hz\n"
      "stamps: {}\n"
      "fitness {:.2f}, particles {}, effective {:.0f}\n"
      "cpu per scan (p50, p99, max): matcher {:.1f}, {:.1f}, {:.1f} ms; filter {:.1f}, {:.1f}, {:.1f} ms\n{}{}{}{}",
      state_sentence(health), pose_text(status), 100.0 * health.pose_probability, status.map.width_m,
      status.map.height_m, status.map.cell_size_m, 100.0 * health.map_pool_used, health.lrf.accepted,
      health.lrf.rejected, health.lrf.dropped, health.scans_not_level, health.lrf.rate_hz, health.lrf.age_s,
      status.poses_hz, times_text(health.lrf.times), health.fitness, health.particles, health.effective_particles,
      matcher.p50_ms, matcher.p99_ms, matcher.max_ms, filter.p50_ms, filter.p99_ms, filter.max_ms, graph_text(health),
      cloud_text(health), status.world ? world_text(*status.world) : "", save_text(status.save));
}

Json status_json(const DaemonStatus& status) {
  const HealthReport& health = status.health;
  Json json{{"state", name_of(health.state)},
            {"reasons", reasons_of(health.reasons)},
            {"reasons_since_start", reasons_of(health.latched_reasons)},
            {"pose", status.pose ? pose_json(*status.pose) : Json()},
            {"pose_probability", health.pose_probability},
            {"map",
             {{"width_m", status.map.width_m},
              {"height_m", status.map.height_m},
              {"cell_size_m", status.map.cell_size_m},
              {"memory_used", health.map_pool_used}}},
            {"rates", {{"scans_hz", health.lrf.rate_hz}, {"poses_hz", status.poses_hz}}},
            {"scans", scans_json(health)},
            {"fitness", health.fitness},
            {"particles", health.particles},
            {"effective_particles", health.effective_particles},
            {"save", save_json(status.save)},
            {"records_dropped", health.records_dropped},
            {"publish_errors", health.publish_errors},
            {"stages",
             {{"sensor", stage_json(health.stages[kSensorStage])},
              {"matcher", stage_json(health.stages[kMatcherStage])},
              {"filter", stage_json(health.stages[kFilterStage])}}}};
  if (health.cloud) {
    json["cloud"] = {{"points", health.cloud->points},
                     {"memory_used", health.cloud->used},
                     {"refused", health.cloud->refused},
                     {"scans_left_out", health.cloud->scans_left_out}};
  }
  if (health.graph) {
    const Pose2& map_T_odom = health.graph->map_T_odom;
    json["pose_graph"] = {
        {"submaps", health.graph->submaps},
        {"loop_closures", health.graph->loop_closures},
        {"memory_used", health.graph->used},
        {"keyframes_left_out", health.graph->keyframes_left_out},
        {"map_T_odom",
         {{"x_m", map_T_odom.x_m}, {"y_m", map_T_odom.y_m}, {"yaw_deg", map_T_odom.yaw_rad * kDegPerRad}}}};
  }
  if (status.world) {
    json["world"] = world_json(*status.world);
  }
  return json;
}

}  // namespace odoless
