#pragma once

#include <array>
#include <cstdint>

#include "core/motion/motion.hpp"
#include "core/scan/laser_mount_params.hpp"

namespace odoless {

/// What the real-time stages tell the outside. All are trivially copyable and of fixed size, so that they can be copied
/// through a ring without a heap call; those with beams, bytes or cells are followed by them in the ring. What a match
/// found is told as it is: core/motion/motion.hpp; so is a keyframe, followed by a BeamCode per beam:
/// core/graph/keyframe.hpp.
///
/// Stamps are those of scans: whole microseconds in nanoseconds, on the monotonic clock with its origin moved once, at
/// start, to the Unix epoch. LCM's utime is stamp_ns / 1000.

enum class RecordType : std::uint32_t {
  kScan = 1,
  kRawBytes,
  kMotion,
  kPose,
  kMapTile,
  kEvent,
  kTilt,
  kPath,
  kKeyframe
};

/// A scan as the device gave it, in its own frame; beams in ignored sectors are 0. Followed by `beams` floats: range in
/// metres; infinity: no return; 0: nothing is known.
struct ScanRecord {
  std::int64_t stamp_ns = 0;
  double start_angle_rad = 0.0;  ///< exact in single precision, as is the step
  double angle_step_rad = 0.0;
  std::int32_t beams = 0;
  std::int64_t beam_period_ns = 0;  ///< from beam to beam; 0: unknown
};

/// Which device's line something was on.
enum class RawLine : std::int32_t { kLaser, kTilt, kGpio };

/// Bytes as they were on the wire; of a CAN bus one frame, as a line of candump, and of GPIO a change (GpioChange).
/// Followed by `size_bytes` bytes.
struct RawBytesRecord {
  std::int64_t stamp_ns = 0;  ///< of the last byte's arrival or departure
  std::int32_t size_bytes = 0;
  std::int32_t to_device = 0;  ///< 1: sent, 0: received
  RawLine line = RawLine::kLaser;
};

/// Where the scan is in the map, as known now. What is told outside is of the robot: RobotPose.
struct PoseRecord {
  std::int64_t stamp_ns = 0;
  Pose2 map_T_scan{};
  Pose2 map_T_odom{};
  Pose2 odom_T_scan{};
  std::array<double, 9> covariance{};  ///< of map_T_scan over (x_m, y_m, yaw_rad), map axes
  std::int64_t update_stamp_ns = 0;    ///< of the filter update that the pose hangs on
  Pose2 update_T_scan{};
  double effective_particles = 0.0;
  double log_likelihood_per_beam = 0.0;
  std::int32_t particles = 0;
  std::int32_t updated = 0;      ///< 1: this scan was an update
  LaserPlace laser{};            ///< on the robot
  std::int32_t map_number = 0;   ///< grows when the map is begun anew
  std::int32_t placements = 0;   ///< FilterStep's
  std::int32_t unconfirmed = 0;  ///< the same
};

/// A measured angle of the laser's tilt axis.
struct TiltRecord {
  std::int64_t stamp_ns = 0;
  double angle_rad = 0.0;  ///< from the level pose, positive is down
  double velocity_radps = 0.0;
};

/// A square piece of the map. Followed by size_cells * size_cells bytes, row by row from the lowest y: occupancy in
/// percent, 255 unknown.
struct MapTileRecord {
  std::int64_t stamp_ns = 0;
  std::int32_t column = 0;  ///< the tile's lower-left corner is at (column, row) * size_cells * cell_size_m, map frame
  std::int32_t row = 0;
  std::int32_t size_cells = 0;
  double cell_size_m = 0.0;
};

/// The best particle's trajectory as known now. Followed by a StampedPose per filter update, oldest first: as many of
/// the last ones as PathSender sends.
struct PathRecord {
  std::int64_t stamp_ns = 0;
};

}  // namespace odoless
