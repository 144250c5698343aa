#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "core/scan/laser_mount_params.hpp"

namespace odoless {

/// TUM trajectory: one line `stamp tx ty tz qx qy qz qw` per pose; seconds, rounded to microseconds, and metres with 6
/// decimals, the unit quaternion of the yaw with 9. The same poses give the same bytes everywhere.
[[nodiscard]] std::string format_trajectory(std::span<const StampedPose> poses);

/// Poses of the scan frame as those of the robot, which are what is written for people.
[[nodiscard]] std::vector<StampedPose> robot_trajectory(std::span<const StampedPose> scans, const LaserPlace& laser);

/// Writes it, whole or not at all. @throws CannotCreateError, IoError.
void write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses);

}  // namespace odoless
