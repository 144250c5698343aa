#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/geometry/stamped_pose.hpp"

namespace odoless {

/// TUM trajectory: one line `stamp tx ty tz qx qy qz qw` per pose; seconds, rounded to microseconds, and metres with 6
/// decimals, the unit quaternion of the yaw with 9. The same poses give the same bytes everywhere.
[[nodiscard]] std::string format_trajectory(std::span<const StampedPose> poses);

/// Writes it, whole or not at all. @throws CannotCreateError, IoError.
void write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses);

}  // namespace odoless
