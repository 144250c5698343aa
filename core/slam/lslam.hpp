#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/deadline.hpp"
#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/occupancy_map.hpp"
#include "core/motion/motion.hpp"
#include "core/motion/scan_matching_motion_model.hpp"
#include "core/motion/travel_speed.hpp"
#include "core/scan/scan_frame.hpp"
#include "core/slam/kld_sampling.hpp"
#include "core/slam/lslam_params.hpp"
#include "core/slam/particle_maps.hpp"
#include "core/slam/pose_search.hpp"
#include "core/slam/scan_beams.hpp"

namespace odoless {

/// What an update did.
struct UpdateReport {
  double effective_particles = 0.0;      ///< before resampling
  bool resampled = false;                ///< also true for the first update, which spreads the first particle
  int beams_weighed = 0;                 ///< 0: the scan had no usable beam, weights stay
  double log_likelihood_per_beam = 0.0;  ///< of the best particle, before tempering; at most 0
  double lambda_m = 0.0;                 ///< travel that the speed promised
  std::int64_t refused_tiles = 0;        ///< observations refused since the pool of tiles is full
  std::int64_t outside_tiles = 0;        ///< observations outside of the grid
  int unweighed_particles = 0;           ///< given up at the deadline
  int thinly_mapped_particles = 0;       ///< 1 if the time was over before all survivors had this scan in their maps:
                                         ///< one got an even choice of its beams,
  int unmapped_particles = 0;            ///< and those after it none
  std::int64_t thinned_poses = 0;        ///< poses that went from the paths since their pool was full
};

/// The particles' opinion in one Gaussian.
struct PoseEstimate {
  static constexpr double kOk_m = 0.5;  ///< what OK promises
  static constexpr double kOk_rad = 0.0873;
  static constexpr double kUnconfirmed = 0.5;  ///< that it is so where Recovery::unconfirmed is not 0

  Pose2 map_T_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< over (x_m, y_m, yaw_rad), map axes
  double agreement = 1.0;  ///< weight of the particles that are as near to it as OK promises
};

/// Low-level DP-SLAM: a particle filter over poses and maps [eliazar2003dpslam, eliazar2004dpslam2; method 7].
///
/// An update (1) draws each particle's pose from the scan-matching motion model, about one of the motion's hypotheses,
/// (2) weighs it by the scan's likelihood
/// in its own map, (3) if too few particles matter, keeps those that a systematic resampling picks, (4) puts the scan,
/// or an even choice of its beams, into the survivors' maps and (5) lets them multiply, to as many as their spread
/// needs (KldSampling). The first update since `reset` does (4) and (5) alone.
///
/// Frames:    poses are map_T_scan: of the laser, x forward, whose scans the matcher compares. The map has no edge: its
///            grid is a window that follows the best particle.
/// Full pool: observations that find no room are refused and counted, and the next update drops the weakest half of the
///            particles, which gives their tiles back.
/// Deadline:  at its end particles not weighed yet are given up as if their weight were 0; the survivor whose map is
///            drawn gets 64 of the beams left, evenly chosen, and those after it go on without this scan in their maps.
///            One particle is always weighed, and one gets 64 beams at least. None in a replay.
/// Thread:    owned by one thread, but for what is copied out.
/// Real time: `update` and `reset` do not allocate, lock or read a clock; the time of an update is bounded by
///            particles, beams and their length in cells, and does not depend on the map's size or the length of the
///            run; past the deadline it is that of weighing one particle, of 128 beams into a map, and of what is
///            linear in the particles and in the tiles that go with them.
/// Promises:  the same seed, increments and scans give the same bits; poses, weights and maps are those of particles
///            with a copied map each (tests/core/slam/lslam_oracle_test.cpp).
class Lslam {
 public:
  Lslam(const LslamParams& params, std::uint64_t seed);

  /// Forgets everything but the generator's state; the next scan is taken from here.
  void reset(const Pose2& map_T_scan);

  /// Puts every particle here; maps and paths stay.
  void set_pose(const Pose2& map_T_scan, const PoseSpread& spread = {});
  /// The last update was too long ago for the speed of then to promise any travel.
  void forget_speed() { speed_.reset(); }

  /// @param motion  From the scan of the last update to this one; ignored in the first. Finite.
  [[nodiscard]] UpdateReport update(const Motion& motion, const ScanFrame& scan, const Deadline& deadline = {});

  /// Most particles that there shall be, 1 to `params.particles`, which it is until somebody asks. Fewer come
  /// with the next update, which then resamples; more with the next resampling that the weights ask for. A replay that
  /// asks for the same before the same updates gives the same bits.
  void set_particles(int wanted);

  /// Particles: one before the first update, then as many as were asked for.
  [[nodiscard]] int particles() const { return particles_.size(); }
  [[nodiscard]] const Pose2& pose(int particle) const { return particles_.pose(particle); }
  /// Sum 1.
  [[nodiscard]] double weight(int particle) const { return particles_.weight(particle); }
  /// The heaviest particle; just after resampling a copy of it.
  [[nodiscard]] int best() const { return particles_.best(); }
  [[nodiscard]] double effective_particles() const { return particles_.effective(); }
  /// Weighted mean and covariance; yaw is averaged on the circle.
  [[nodiscard]] PoseEstimate estimate() const;

  /// A particle's map, to read cells from; not const, since looks are remembered.
  [[nodiscard]] AncestryGrid::View map(int particle) { return particles_.grid().view(particle); }
  /// The best particle's map. May allocate, in `map` alone.
  void write_occupancy(OccupancyMap& map) { particles_.grid().write_occupancy(best(), params_.beam.rho_min_m, map); }
  /// A square of the best particle's map: AncestryGrid::write_square.
  [[nodiscard]] bool write_square(GridCell corner, int side_cells, std::span<std::uint8_t> percent) {
    return particles_.grid().write_square(best(), params_.beam.rho_min_m, corner, side_cells, percent);
  }
  /// The best particle's poses, one per update, oldest first. May allocate, in `path` alone.
  void write_path(std::vector<StampedPose>& path) const { particles_.paths().write_path(best(), path); }
  /// The last poses of a particle's path, see PathPool::copy_last.
  [[nodiscard]] int copy_last_poses(int particle, std::span<StampedPose> last) const {
    return particles_.paths().copy_last(particle, last);
  }

  [[nodiscard]] const LslamParams& params() const { return params_; }
  [[nodiscard]] const GridGeometry& geometry() const { return particles_.grid().geometry(); }
  /// Tiles of the pool in use, of `params.grid.tiles_max`.
  [[nodiscard]] int tiles_used() const { return particles_.grid().tiles_used(); }

 private:
  void move(const Motion& motion, UpdateReport& report);
  void weigh(const ScanFrame& scan, const Deadline& deadline, UpdateReport& report);
  void weigh_until(const Deadline& deadline, UpdateReport& report);
  [[nodiscard]] ScoredPose refined(int particle, std::span<const Beam> beams);
  [[nodiscard]] bool select_survivors(UpdateReport& report);
  [[nodiscard]] int particles_needed();
  void map_scan(const ScanFrame& scan, const Deadline& deadline, UpdateReport& report);
  [[nodiscard]] bool map_until(const Deadline& deadline, int particle, const ScanPart& part);
  /// Lets the window of the maps follow the robot, and parts of them grow old.
  void move_window(const Motion& motion);
  [[nodiscard]] GridCell cell_of(const Pose2& map_T_scan) const;
  void count(const AncestryGrid::Counters& before, std::int64_t thinned_before, UpdateReport& report);

  LslamParams params_;
  ScanMatchingMotionModel motion_;
  BeamModel model_;
  ParticleMaps particles_;
  KldSampling kld_;
  TravelSpeed speed_;
  Rng rng_;
  std::vector<double> scores_;
  std::vector<DrawnError> errors_;  ///< what each particle takes the odometry to be off by now
  std::vector<DrawnError> old_errors_;
  std::vector<Beam> beams_;
  double travel_m_ = 0.0;  ///< of all updates
  int turn_ = 0;           ///< of the beams that take turns in being mapped: the first of the last update
  int wanted_particles_;
  bool started_ = false;
  bool pool_was_full_ = false;
};

}  // namespace odoless
