#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/slam/hslam.hpp"
#include "core/slam/lslam.hpp"
#include "core/slam/segment.hpp"
#include "core/slam/slam_params.hpp"

namespace odoless {

/// Hierarchical DP-SLAM [eliazar2004dpslam2; method 7]: LSLAM follows the scans; its run is cut into segments, over
/// which HSLAM keeps hypotheses of the whole run that live long enough to close loops.
///
/// HSLAM works on a segment while LSLAM fills the next, a slice with every call of `work`; a segment is done before the
/// next one ends as long as `work` is called once per update.
///
/// Frames:    `low` is LSLAM's map frame, `map` HSLAM's; both begin at the first scan. map_T_low changes when a segment
///            is finished.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction but where said; bounded work per call.
class Slam {
 public:
  Slam(const SlamParams& params, const ScanParams& scan, std::uint64_t seed);

  /// Forgets everything but the generators' states; the next scan is taken from here.
  void reset(const Pose2& map_T_scan);
  /// Puts every hypothesis here; maps and paths stay. With HSLAM the segment that is being filled ends first, which is
  /// not for real time.
  void set_pose(const Pose2& map_T_scan, const PoseSpread& spread = {});
  /// A slice towards a filter with nothing left to do, so that `set_pose` is for real time: ends the segment that is
  /// being filled. @return  Whether it is there; the map then stays as it is until the next update.
  [[nodiscard]] bool settle();
  /// @param motion  From the scan of the last update to this one; ignored in the first.
  /// @param deadline   See Lslam.
  [[nodiscard]] UpdateReport update(const Motion& motion, const ScanFrame& scan, const Deadline& deadline = {});
  /// One slice of HSLAM's work.
  void work();
  /// Ends the segment that is being filled, and finishes it: when a run is over. Not for real time.
  void finish();
  void set_particles(int wanted) { low_.set_particles(wanted); }

  /// Where the last update's scan was, as known now.
  [[nodiscard]] Pose2 map_T_scan() const;

  /// The low level's opinion, in the map frame.
  [[nodiscard]] PoseEstimate estimate() const;
  [[nodiscard]] double effective_particles() const { return low_.effective_particles(); }
  [[nodiscard]] int particles() const { return low_.particles(); }

  /// The best map there is: HSLAM's up to its last segment, or LSLAM's. May allocate, in `map` alone.
  void write_occupancy(OccupancyMap& map);
  /// A square of that map: AncestryGrid::write_square.
  [[nodiscard]] bool write_square(GridCell corner, int side_cells, std::span<std::uint8_t> percent);
  /// The same map to look things up in, and where its cells lie.
  [[nodiscard]] AncestryGrid::View map_view();
  [[nodiscard]] const GridGeometry& map_geometry() const;
  /// One pose per update, as known now. May allocate. Only when HSLAM is idle, as after `finish`.
  void write_path(std::vector<StampedPose>& path) const;
  /// The last of these poses, oldest first; their number, 0 while HSLAM works. No allocation; linear in the span.
  [[nodiscard]] int copy_last_poses(std::span<StampedPose> last) const;

  [[nodiscard]] const SlamParams& params() const { return params_; }
  /// Of the map that is written.
  [[nodiscard]] const GridGeometry& geometry() const;
  /// Share of the fuller level's pool of tiles.
  [[nodiscard]] double pool_used() const;
  [[nodiscard]] Lslam& low() { return low_; }
  [[nodiscard]] const Lslam& low() const { return low_; }
  /// None if `high.particles` is 0.
  [[nodiscard]] const Hslam* high() const { return high_ ? &*high_ : nullptr; }

 private:
  [[nodiscard]] bool has_segments() const { return high_ && high_->report().segments > 0; }
  [[nodiscard]] Pose2 map_T_low() const;
  void close_segment();
  void run(int particles);
  /// The best low-level particle's pose at the end of HSLAM's last segment.
  [[nodiscard]] Pose2 low_T_finished() const;

  SlamParams params_;
  Lslam low_;
  std::optional<Hslam> high_;
  std::vector<RunSegment> segments_;  ///< the one that is filled, the one that HSLAM works on
  int filling_ = 0;
  int slices_per_call_ = 0;
  int updates_unfinished_ = 0;  ///< since the end of HSLAM's last segment
  int updates_in_work_ = 0;
  mutable std::vector<StampedPose> last_;
};

}  // namespace odoless
