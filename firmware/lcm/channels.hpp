#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace odoless {

/// LCM's own limit of a channel's name.
inline constexpr std::size_t kChannelMaxBytes = 63;

/// Longest prefix that leaves room for the longest name.
inline constexpr std::size_t kChannelPrefixMaxBytes = 40;

/// The names of all channels, with one prefix, so that several robots can share a network. README.md says what each
/// carries.
struct Channels {
  std::string scan;             ///< bot_core.planar_lidar_t
  std::string scan_again;       ///< the last scan once more, for a filter elsewhere
  std::string scan_times;       ///< odoless.scan_times_t
  std::string lrf_raw_rx;       ///< bot_core.raw_t, received from the device
  std::string lrf_raw_tx;       ///< bot_core.raw_t, sent to the device
  std::string tilt_raw_rx;      ///< bot_core.raw_t, received from the tilt servo; of CAN a line of candump each
  std::string tilt_raw_tx;      ///< bot_core.raw_t, sent to it, likewise
  std::string gpio_raw_rx;      ///< bot_core.raw_t, what came over GPIO lines: a change each (GpioChange)
  std::string gpio_raw_tx;      ///< bot_core.raw_t, what the daemon set, likewise
  std::string tilt;             ///< bot_core.joint_state_t, joint "tilt"
  std::string motion;           ///< odoless.motion_t
  std::string motion_again;     ///< the last motion once more
  std::string pose;             ///< bot_core.pose_t, of the robot
  std::string laser_pose;       ///< bot_core.pose_t, of the laser on it
  std::string pose_covariance;  ///< odoless.pose_estimate_t, of the robot
  std::string map_to_odom;      ///< bot_core.rigid_transform_t
  std::string correction;       ///< odoless.correction_t
  std::string map_tile;         ///< odoless.map_tile_t
  std::string map;              ///< occ_map.pixel_map_t
  std::string health;           ///< odoless.health_t
  std::string cloud_health;     ///< odoless.cloud_health_t
  std::string world;            ///< odoless.world_t
  std::string lrf_status;       ///< bot_core.sensor_status_t
  std::string scan_points;      ///< bot_core.pointcloud_t
  std::string cloud;            ///< bot_core.pointcloud_t, channels "key" and "edition"

  explicit Channels(std::string_view prefix = "ODOLESS_");

  /// Whether a daemon with a filter alone takes messages of that channel.
  [[nodiscard]] bool is_taken(std::string_view channel) const;
};

/// The channel that tells when the beams of scans on this one are measured.
[[nodiscard]] std::string times_channel(std::string_view scan_channel);

}  // namespace odoless
