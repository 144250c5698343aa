#pragma once

#include <bot_core/joint_state_t.hpp>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pointcloud_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/raw_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <bot_core/sensor_status_t.hpp>
#include <cstddef>
#include <cstdint>
#include <occ_map/pixel_map_t.hpp>
#include <odoless/cloud_health_t.hpp>
#include <odoless/correction_t.hpp>
#include <odoless/health_t.hpp>
#include <odoless/map_tile_t.hpp>
#include <odoless/motion_t.hpp>
#include <odoless/pose_estimate_t.hpp>
#include <odoless/scan_times_t.hpp>
#include <odoless/world_t.hpp>
#include <span>

#include "core/geometry/pose2.hpp"
#include "core/graph/map_correction.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "firmware/records/cloud_piece.hpp"
#include "firmware/records/health.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// Records to LCM messages. The messages are kept by the caller, so that their vectors keep their memory: none of these
/// allocates once the vectors have grown to what they hold at most.

/// Largest encoded message, so that one datagram carries it and a receiver with default buffers gets it.
inline constexpr std::size_t kMessageMaxBytes = 60'000;

/// Most points of a pointcloud_t below that size.
inline constexpr int kPointsMax = 4900;

/// The same with two further figures each.
inline constexpr int kCloudPointsMax = 2900;

/// Velocity over ground of the laser, axes of the map.
struct Velocity {
  double x_mps = 0.0;
  double y_mps = 0.0;
  double yaw_radps = 0.0;
};

/// Mean velocity over the motion that ended at a scan at `map_yaw_rad`; zero where nothing was matched.
[[nodiscard]] Velocity velocity_of(const Motion& motion, double map_yaw_rad);

void to_message(const ScanRecord& scan, std::span<const float> ranges_m, bot_core::planar_lidar_t& message);
void to_message(const ScanRecord& scan, scan_times_t& message);
void to_message(const RawBytesRecord& raw, std::span<const std::byte> bytes, bot_core::raw_t& message);
/// One joint, "tilt".
void to_message(const TiltRecord& tilt, bot_core::joint_state_t& message);
void to_message(const Motion& motion, motion_t& message);
void to_message(const PoseRecord& pose, pose_estimate_t& message);
/// Of the robot. @param velocity  Of the laser.
void to_message(const PoseRecord& pose, const Velocity& velocity, bot_core::pose_t& message);
/// Of the laser: what takes its scan's own coordinates to the map; where left and right are swapped, with half a roll.
void to_laser_message(const PoseRecord& pose, const Velocity& velocity, bot_core::pose_t& message);
void to_message(const HealthReport& health, health_t& message);
void to_message(const CloudHealth& cloud, std::int64_t stamp_ns, cloud_health_t& message);
void to_message(const WorldHealth& world, const HealthReport& health, world_t& message);
void to_message(const MapCorrection& correction, correction_t& message);
/// All but the data, which are compressed.
void to_message(const MapTileRecord& tile, std::int32_t sequence, map_tile_t& message);
/// `map_T_odom` of a pose.
void to_message(const PoseRecord& pose, bot_core::rigid_transform_t& message);
/// That the laser lives, as told by `health`. Lasers that bot_core has no type for have -1.
void to_message(const HealthReport& health, LrfDriver laser, bot_core::sensor_status_t& message);

/// The scan's returns in the map, at most `kPointsMax`: with more, every second is left out, or two of three, and so
/// on. `message.points` has kPointsMax points of three coordinates, of which the first `n_points` count.
void to_points(const PoseRecord& pose, const ScanRecord& scan, std::span<const float> ranges_m,
               bot_core::pointcloud_t& message);

/// Points of the 3D map, in the map, at most kCloudPointsMax. Their further figures are "key", the number of the key
/// pose that they hang on, and "edition", which grows when that key is published anew: a reader then forgets the points
/// of the editions before. `message` has room as made by `reserve_cloud`.
void reserve_cloud(bot_core::pointcloud_t& message);
void to_message(const CloudPiece& piece, bot_core::pointcloud_t& message);

}  // namespace odoless
