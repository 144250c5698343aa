#include "tools/output/trajectory.hpp"

#include <fmt/format.h>

#include <iterator>

#include "core/math/elementary.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

/// Seconds with 6 decimals, from the integer: a double of an epoch time has lost them.
std::string format_stamp_s(std::int64_t stamp_ns) {
  const bool negative = stamp_ns < 0;
  const std::uint64_t size_ns =
      negative ? 0 - static_cast<std::uint64_t>(stamp_ns) : static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t size_us = (size_ns + 500) / 1000;
  return fmt::format("{}{}.{:06}", negative && size_us > 0 ? "-" : "", size_us / 1'000'000, size_us % 1'000'000);
}

}  // namespace

std::string format_trajectory(std::span<const StampedPose> poses) {
  std::string text;
  for (const StampedPose& stamped : poses) {
    const Pose2& pose = stamped.map_T_scan;
    fmt::format_to(std::back_inserter(text), "{} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", format_stamp_s(stamped.stamp_ns),
                   pose.x_m, pose.y_m, math::sin(pose.yaw_rad / 2.0), math::cos(pose.yaw_rad / 2.0));
  }
  return text;
}

std::vector<StampedPose> robot_trajectory(std::span<const StampedPose> scans, const LaserPlace& laser) {
  std::vector<StampedPose> robot(scans.begin(), scans.end());
  for (StampedPose& pose : robot) {
    pose.map_T_scan = laser.robot_of(pose.map_T_scan);
  }
  return robot;
}

void write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses) {
  write_whole_file(path, format_trajectory(poses));
}

}  // namespace odoless
