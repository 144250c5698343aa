#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/rng.hpp"
#include "core/grid/occupancy_map.hpp"
#include "core/slam/hslam_params.hpp"
#include "core/slam/particle_maps.hpp"
#include "core/slam/scan_beams.hpp"
#include "core/slam/segment.hpp"

namespace odoless {

/// What the last finished segment did to the high level.
struct SegmentReport {
  std::int64_t segments = 0;  ///< finished so far
  double effective_particles = 0.0;
  bool resampled = false;
  double log_likelihood_per_beam = 0.0;  ///< of the best particle in its own map, before tempering
  std::int64_t refused_tiles = 0;
  std::int64_t outside_tiles = 0;
};

/// High-level DP-SLAM: a particle filter over whole segments of the low level's run [eliazar2004dpslam2, section 4;
/// method 7].
///
/// For each particle a segment is one motion, (1) drawn from the low level's paths plus drift, made better by a search
/// in the particle's own map, and one observation, (2) which weighs the particle by some of the segment's scans. Then
/// (3) the weak ones go, (4) all scans are put into the survivors' maps, which (5) multiply. The first segment, with no
/// map to weigh it in, does (4) and (5) alone.
///
/// The work is done in slices: `begin`, then `work` until `idle`. How it is sliced does not change the result.
///
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; a slice is bounded by its particles, their beams and refinements.
class Hslam {
 public:
  Hslam(const HslamParams& params, std::uint64_t seed);

  void reset(const Pose2& map_T_scan);

  /// Puts every particle here; maps and paths stay. Only when idle.
  void set_pose(const Pose2& map_T_scan, const PoseSpread& spread = {});

  /// Takes on a segment, which must not change until `idle`. Only when idle.
  void begin(const RunSegment& segment);
  /// Goes on for so many particles' worth of work. Returns whether this finished the segment.
  bool work(int particles);
  [[nodiscard]] bool idle() const { return phase_ == Phase::kIdle; }
  /// Slices of one particle that a segment takes at most.
  [[nodiscard]] int slices() const { return 2 * params_.particles + 1; }

  [[nodiscard]] const SegmentReport& report() const { return report_; }
  /// The heaviest particle, where it was at the end of the last finished segment.
  [[nodiscard]] const Pose2& best_pose() const { return best_pose_; }
  [[nodiscard]] const ParticleMaps& particles() const { return particles_; }
  /// The heaviest particle's map, to look things up in.
  [[nodiscard]] AncestryGrid::View map() { return particles_.grid().view(particles_.best()); }
  /// The same as occupancies. May allocate, in `map` alone.
  void write_occupancy(OccupancyMap& map) {
    particles_.grid().write_occupancy(particles_.best(), params_.beam.rho_min_m, map);
  }
  /// A square of it: AncestryGrid::write_square.
  [[nodiscard]] bool write_square(GridCell corner, int side_cells, std::span<std::uint8_t> percent) {
    return particles_.grid().write_square(particles_.best(), params_.beam.rho_min_m, corner, side_cells, percent);
  }
  /// Its path, a pose per scan of all finished segments. May allocate, in `path` alone. Only when idle.
  void write_path(std::vector<StampedPose>& path) const { particles_.paths().write_path(particles_.best(), path); }
  /// The last of these, oldest first: PathPool::copy_last. Only when idle.
  [[nodiscard]] int copy_last_poses(std::span<StampedPose> last) const {
    return particles_.paths().copy_last(particles_.best(), last);
  }

 private:
  enum class Phase : std::uint8_t { kIdle, kWeigh, kChoose, kMap };

  /// A particle's motion over the segment.
  struct Motion {
    int path = 0;
    Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  };

  void pick_scans();
  [[nodiscard]] int draw_path();
  void weigh(int particle);
  [[nodiscard]] double log_likelihood_of(int particle, const Motion& motion);
  void choose();
  void map(int particle);
  void finish();

  HslamParams params_;
  BeamModel model_;
  ParticleMaps particles_;
  Rng rng_;
  std::vector<Motion> motions_;
  std::vector<double> scores_;
  std::vector<std::vector<Beam>> beams_;  ///< of the scans weighed
  std::vector<int> scans_weighed_;
  int beams_weighed_ = 0;
  const RunSegment* segment_ = nullptr;
  Eigen::Matrix3d drift_root_ = Eigen::Matrix3d::Zero();  ///< of the drift's covariance, by Cholesky
  Phase phase_ = Phase::kIdle;
  int next_ = 0;
  bool started_ = false;
  bool pool_was_full_ = false;
  AncestryGrid::Counters before_{};
  Pose2 best_pose_{};
  SegmentReport report_{};
};

}  // namespace odoless
