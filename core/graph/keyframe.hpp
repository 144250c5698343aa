#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/geometry/pose2.hpp"
#include "core/graph/odometry_stretch.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// A scan that is kept for good, but for its beams. Trivially copyable, so that it can go through rings as bytes.
struct Keyframe {
  std::int64_t stamp_ns = 0;
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  std::int32_t beams = 0;
  std::int32_t map_number = 0;  ///< grows when mapping begins anew
  Pose2 odom_T_scan{};
  Pose2 map_T_odom{};            ///< as the filter has it; where a map begins, this is where
  OdometryStretch since_last{};  ///< from the keyframe before
};

static_assert(std::is_trivially_copyable_v<Keyframe>);

/// A beam of a keyframe in 16 bits: 4 mm up to 262 m.
using BeamCode = std::uint16_t;

/// Beams that a keyframe of this scan has: of more than `beams_max` only every second, third, ...
[[nodiscard]] int keyframe_beams(int scan_beams, int beams_max);

/// Writes a scan's beams and angles into a keyframe. Beams are stored at even angles; one that the deskewing has moved
/// goes to the angle next to it. Linear in the beams, no allocation.
/// @param codes  keyframe_beams(scan.size(), beams_max) of them.
void encode(const ScanFrame& scan, int beams_max, Keyframe& keyframe, std::span<BeamCode> codes);

/// 0 for a beam that says nothing, kNoReturn_m for one without return.
[[nodiscard]] float range_of(BeamCode code);
inline constexpr float kNoReturn_m = 1000.0F;

}  // namespace odoless
