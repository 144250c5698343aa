#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/cloud_mapper.hpp"
#include "core/cloud/mapping_params.hpp"
#include "core/cloud/pose_track.hpp"
#include "core/geometry/stamped_pose.hpp"
#include "core/scan/laser_mount.hpp"
#include "drivers/tilt/tilt_history.hpp"
#include "firmware/records/cloud_piece.hpp"
#include "firmware/records/health.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// Makes the cloud from what the real-time stages tell: waits with each scan until the angles and poses of its beams
/// are known, and says which points are to be published: new ones, and those of a key anew that has been corrected or
/// is complete.
///
/// Thread: publisher thread, off the way of the poses. No allocation after construction; `work` takes at most
///         kScansPerRound scans, `finish` all that wait.
class CloudFeed {
 public:
  CloudFeed(const MappingParams& params, int beams_max, const LaserMountParams& mount = {});

  void add(const TiltRecord& tilt);
  void add(const ScanRecord& scan, std::span<const float> ranges_m);
  /// The poses in the smooth frame: of level scans.
  void add(const Motion& motion);
  /// Of a map that was begun anew, as its first pose says, nothing of before is kept.
  void add(const PoseRecord& pose);
  /// The trajectory as known now, a pose per filter update: keys are put where it has them.
  void correct(std::span<const StampedPose> path);

  /// Puts the scans that are ready into the cloud.
  void work();
  /// The end: puts all that are ready into the cloud, and its keys where the final trajectory has them.
  void finish(std::span<const StampedPose> path);
  /// The next points to be published; none: `points` is empty. Valid until the next call of anything here.
  [[nodiscard]] CloudPiece next_piece(std::size_t points_max);

  [[nodiscard]] const KeyedCloud& cloud() const { return mapper_.cloud(); }
  /// Scans are left out where their poses or angles never came, or too many waited.
  [[nodiscard]] CloudHealth health() const;

 private:
  static constexpr std::size_t kWaiting = 256;  ///< two gaps between poses of 2 s (pose_gap_max_s), at 40 Hz and more
  static constexpr std::size_t kPoses = 1024;
  static constexpr int kScansPerRound = 16;
  static constexpr std::size_t kNewPointsMin = 1000;  ///< of a key that still grows: no message for a few points
  static constexpr double kMovedM = 0.05;             ///< a key that is corrected by less is not published again
  static constexpr double kMovedRad = 0.01;
  static constexpr double kLeapM = 1.0;  ///< a robot that is put there or found again: a key begins

  struct Waiting {
    ScanRecord scan;
    std::vector<float> ranges_m;
  };
  /// Where a key hangs on the filter's path, and how much of it was published.
  struct KeyState {
    std::int64_t update_stamp_ns = 0;
    Pose2 update_T_key{};
    Pose2 map_T_published{};  ///< where its first point was published
    std::size_t published = 0;
    std::int32_t edition = 0;
  };
  enum class Readiness : std::uint8_t { kReady, kWait, kNever };

  [[nodiscard]] const Waiting& oldest() const { return waiting_[first_ % kWaiting]; }
  void drop_oldest();
  void begin_anew();
  [[nodiscard]] bool is_leap(const PoseRecord& pose) const;
  [[nodiscard]] Readiness readiness(const ScanRecord& scan) const;
  void map(const Waiting& waiting);
  void remember_keys(std::int64_t stamp_ns);
  static void begin_edition(KeyState& state, const CloudKey& key);

  MappingParams params_;
  CloudMapper mapper_;
  LaserMount mount_;
  ScanFrame frame_;
  TiltHistory tilts_;
  PoseTrack odom_T_scan_;
  std::vector<Waiting> waiting_;
  std::size_t first_ = 0;
  std::size_t end_ = 0;
  std::vector<double> tilts_rad_;
  std::vector<KeyState> keys_;
  PoseRecord pose_{};
  bool has_pose_ = false;
  std::size_t next_key_ = 0;
  std::int32_t editions_before_ = 0;  ///< of the maps before this one
  std::int64_t left_out_ = 0;
};

}  // namespace odoless
