#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "core/graph/keyframe.hpp"

namespace odoless {

/// What a world file holds as bytes, little-endian. Reading gives false where the bytes are no such thing, or a number
/// is not finite.

/// Differences from beam to beam, first all low bytes, then all high ones, packed by zlib: half the size. As they are
/// where that is not shorter.
[[nodiscard]] std::vector<std::byte> pack_beams(std::span<const BeamCode> codes);
[[nodiscard]] bool unpack_beams(std::span<const std::byte> bytes, std::span<BeamCode> codes);

/// 17 doubles: start_T_end, covariance by rows, slip, distance, rotation, unknown_s.
[[nodiscard]] std::vector<std::byte> pack_stretch(const OdometryStretch& stretch);
[[nodiscard]] bool unpack_stretch(std::span<const std::byte> bytes, OdometryStretch& stretch);

/// 9 doubles, by rows.
[[nodiscard]] std::vector<std::byte> pack_covariance(const Eigen::Matrix3d& covariance);
[[nodiscard]] bool unpack_covariance(std::span<const std::byte> bytes, Eigen::Matrix3d& covariance);

/// Of each pose its stamp as a 64-bit integer, then x, y and yaw as doubles.
[[nodiscard]] std::vector<std::byte> pack_poses(std::span<const StampedPose> poses);
/// Appends them.
[[nodiscard]] bool unpack_poses(std::span<const std::byte> bytes, std::vector<StampedPose>& poses);

}  // namespace odoless
