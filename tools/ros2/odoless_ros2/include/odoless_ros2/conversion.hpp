#pragma once

#include <algorithm>
#include <array>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <odoless/health_t.hpp>
#include <odoless/pose_estimate_t.hpp>
#include <span>
#include <string>

#include "core/geometry/pose2.hpp"

namespace odoless::ros {

/// The daemon's LCM messages to ROS 2's. Each function fills a message of any type with the fields of ROS's: rclcpp's
/// own in the bridge, plain structs where odoless writes a file for Foxglove. Nothing here needs ROS.
///
/// Frames as in REP 105: map_T_odom jumps where the map is corrected, odom_T_base never does.

/// The names of the frames.
struct Frames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";
  std::string laser = "laser";
};

template <class Time>
void set_time(std::int64_t utime, Time& time) {
  constexpr std::int64_t kPerSecond = 1'000'000;
  const std::int64_t rest_us = (utime % kPerSecond + kPerSecond) % kPerSecond;
  time.sec = static_cast<std::int32_t>((utime - rest_us) / kPerSecond);
  time.nanosec = static_cast<std::uint32_t>(rest_us * 1000);
}

template <class Header>
void set_header(std::int64_t utime, const std::string& frame, Header& header) {
  set_time(utime, header.stamp);
  header.frame_id = frame;
}

template <class Quaternion>
void set_yaw(double yaw_rad, Quaternion& quaternion) {
  quaternion.x = 0.0;
  quaternion.y = 0.0;
  quaternion.z = std::sin(0.5 * yaw_rad);
  quaternion.w = std::cos(0.5 * yaw_rad);
}

template <class Pose>
void set_pose(const Pose2& pose, Pose& out) {
  out.position.x = pose.x_m;
  out.position.y = pose.y_m;
  out.position.z = 0.0;
  set_yaw(pose.yaw_rad, out.orientation);
}

/// The pose in the plane that a ROS pose comes to.
template <class Pose>
[[nodiscard]] Pose2 pose_of(const Pose& pose) {
  const auto& q = pose.orientation;
  return {pose.position.x, pose.position.y,
          std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))};
}

[[nodiscard]] inline Pose2 pose_of(const bot_core::rigid_transform_t& transform) {
  return {transform.trans[0], transform.trans[1], 2.0 * std::atan2(transform.quat[3], transform.quat[0])};
}

[[nodiscard]] inline Pose2 pose_of(const pose_estimate_t& estimate) {
  return {estimate.pose[0], estimate.pose[1], estimate.pose[2]};
}

template <class TransformStamped>
void set_transform(std::int64_t utime, const std::string& parent, const std::string& child, const Pose2& parent_T_child,
                   TransformStamped& out) {
  set_header(utime, parent, out.header);
  out.child_frame_id = child;
  out.transform.translation.x = parent_T_child.x_m;
  out.transform.translation.y = parent_T_child.y_m;
  out.transform.translation.z = 0.0;
  set_yaw(parent_T_child.yaw_rad, out.transform.rotation);
}

/// map -> odom and odom -> base of one moment.
template <class TFMessage>
void to_ros(const pose_estimate_t& estimate, const Pose2& map_T_odom, const Frames& frames, TFMessage& out) {
  out.transforms.resize(2);
  set_transform(estimate.utime, frames.map, frames.odom, map_T_odom, out.transforms[0]);
  set_transform(estimate.utime, frames.odom, frames.base, map_T_odom.inverse() * pose_of(estimate), out.transforms[1]);
}

/// The base in the map, which the daemon's poses are of. Of z, roll and pitch nothing is claimed but that they are 0.
template <class PoseWithCovarianceStamped>
void to_ros(const pose_estimate_t& estimate, const Frames& frames, PoseWithCovarianceStamped& out) {
  set_header(estimate.utime, frames.map, out.header);
  set_pose(pose_of(estimate), out.pose.pose);
  constexpr std::size_t kSide = 6;
  constexpr std::array<std::size_t, 3> kAt{0, 1, 5};  // of x, y and yaw
  out.pose.covariance = {};
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    for (std::size_t j = 0; j < kAt.size(); ++j) {
      out.pose.covariance[kSide * kAt[i] + kAt[j]] = estimate.covariance[3 * i + j];
    }
  }
}

/// What planar_lidar_t does not say of a scan.
struct ScanExtent {
  double beam_period_s = 0.0;
  double scan_period_s = 0.0;
  float range_max_m = std::numeric_limits<float>::infinity();  ///< this and more is no return
};

/// As in REP 117: infinity where nothing was hit, not a number where nothing is known.
template <class LaserScan>
void to_ros(const bot_core::planar_lidar_t& scan, const ScanExtent& extent, const Frames& frames, LaserScan& out) {
  set_header(scan.utime, frames.laser, out.header);
  out.angle_min = scan.rad0;
  out.angle_increment = scan.radstep;
  out.angle_max = scan.rad0 + scan.radstep * static_cast<float>(std::max(scan.nranges - 1, 0));
  out.time_increment = static_cast<float>(extent.beam_period_s);
  out.scan_time = static_cast<float>(extent.scan_period_s);
  out.range_min = 0.0F;
  out.range_max = extent.range_max_m;
  out.ranges.resize(scan.ranges.size());
  std::transform(scan.ranges.begin(), scan.ranges.end(), out.ranges.begin(), [&extent](float range_m) {
    return range_m >= extent.range_max_m ? std::numeric_limits<float>::infinity()
           : range_m > 0.0F              ? range_m
                                         : std::numeric_limits<float>::quiet_NaN();
  });
  out.intensities.assign(scan.intensities.begin(), scan.intensities.end());
}

/// A map's place and size; as nav_msgs/OccupancyGrid and occ_map.pixel_map_t have it in common.
struct GridExtent {
  std::int64_t utime = 0;
  double lower_left_x_m = 0.0;
  double lower_left_y_m = 0.0;
  double cell_size_m = 0.0;
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
};

/// @param percent  Of columns * rows cells, row by row from the lowest y; more than 100 is unknown.
template <class OccupancyGrid>
void to_ros(const GridExtent& extent, std::span<const std::uint8_t> percent, const Frames& frames, OccupancyGrid& out) {
  set_header(extent.utime, frames.map, out.header);
  set_time(extent.utime, out.info.map_load_time);
  out.info.resolution = static_cast<float>(extent.cell_size_m);
  out.info.width = extent.columns;
  out.info.height = extent.rows;
  set_pose(Pose2{extent.lower_left_x_m, extent.lower_left_y_m, 0.0}, out.info.origin);
  out.data.resize(percent.size());
  std::transform(percent.begin(), percent.end(), out.data.begin(), [](std::uint8_t cell) {
    constexpr std::uint8_t kMax_percent = 100;
    return cell > kMax_percent ? std::int8_t{-1} : static_cast<std::int8_t>(cell);
  });
}

/// A reason of `health_t`, in a few words; empty: no such bit.
[[nodiscard]] inline const char* reason_text(int bit) {
  static constexpr std::array kTexts{"no scans",
                                     "laser cannot be opened",
                                     "scans refused",
                                     "laser sees nothing",
                                     "same scan again and again",
                                     "scans do not match each other",
                                     "unconstrained direction",
                                     "scans do not fit to the map",
                                     "overload",
                                     "deadline missed",
                                     "no real-time scheduling or locked memory",
                                     "a file cannot be written",
                                     "map full",
                                     "LCM messages cannot be sent",
                                     "a stage does not answer",
                                     "datagrams lost",
                                     "mapping paused",
                                     "emergency stop",
                                     "GPIO line or sync pulse missing",
                                     "tilt servo does not obey",
                                     "laser not level",
                                     "3D map full",
                                     "tilt servo's answers missing or wrong",
                                     "motions received over LCM refused",
                                     "LCM messages that are not authentic refused",
                                     "commanded sweep"};
  return bit >= 0 && static_cast<std::size_t>(bit) < kTexts.size() ? kTexts[static_cast<std::size_t>(bit)] : "";
}

/// "DEGRADED: map full, laser not level".
[[nodiscard]] inline std::string state_text(const health_t& health) {
  static constexpr std::array kStates{"INIT", "OK", "DEGRADED", "LOST", "FAULT"};
  const auto state = static_cast<std::size_t>(health.state);
  std::string text = state < kStates.size() ? kStates[state] : "?";
  const char* separator = ": ";
  constexpr int kBits = 32;
  for (int bit = 0; bit < kBits; ++bit) {
    if ((static_cast<std::uint32_t>(health.reasons) >> static_cast<unsigned>(bit) & 1U) != 0) {
      const std::string reason = reason_text(bit);
      text += separator + (reason.empty() ? "reason " + std::to_string(bit) : reason);
      separator = ", ";
    }
  }
  return text;
}

/// One status: OK, a warning where poses can be used with care, an error where they cannot; stale before the first.
template <class DiagnosticArray>
void to_ros(const health_t& health, DiagnosticArray& out) {
  set_header(health.utime, "", out.header);
  out.status.resize(1);
  auto& status = out.status.front();
  static constexpr std::array<std::uint8_t, 5> kLevels{3, 0, 1, 2, 2};
  const auto state = static_cast<std::size_t>(health.state);
  status.level = state < kLevels.size() ? kLevels[state] : kLevels.back();
  status.name = "odoless: localisation and mapping";
  status.hardware_id = "odoless";
  status.message = state_text(health);
  status.values.clear();
  const auto add = [&status](const char* key, const std::string& value) {
    status.values.emplace_back();
    status.values.back().key = key;
    status.values.back().value = value;
  };
  add("pose_probability", std::to_string(health.pose_probability));
  add("position_sd_m", std::to_string(health.position_sd_m));
  add("yaw_sd_rad", std::to_string(health.yaw_sd_rad));
  add("fitness", std::to_string(health.fitness));
  add("scan_rate_hz", std::to_string(health.lrf.rate_hz));
  add("scan_age_s", std::to_string(health.lrf.age_s));
  add("scans_accepted", std::to_string(health.lrf.accepted));
  add("scans_rejected", std::to_string(health.lrf.rejected));
  add("scans_dropped", std::to_string(health.lrf.dropped));
  add("map_pool_used", std::to_string(health.map_pool_used));
}

}  // namespace odoless::ros
