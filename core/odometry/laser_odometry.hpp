#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/deadline.hpp"
#include "core/base/parameters.hpp"
#include "core/base/rng.hpp"
#include "core/base/usual_level.hpp"
#include "core/match/match_reference.hpp"
#include "core/match/ndt_matcher.hpp"
#include "core/motion/motion.hpp"
#include "core/motion/robot_limits.hpp"
#include "core/odometry/map_slip.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// The local map's reference: its points are dense, so that smaller cells serve it better than a single scan; and the
/// free space of scans from many places contradicts them where they err.
[[nodiscard]] inline ReferenceParams local_map_params() {
  ReferenceParams params;
  params.ndt.cell_size_m = 0.5;
  params.free_penalty = 0.0;
  return params;
}

struct LaserOdometryParams {
  ReferenceParams local_map = local_map_params();
  int key_scans = 40;
  double key_distance_m = 0.3;
  double key_rotation_rad = 0.35;
  double period_min_s = 0.02;
  double expectation_period_min_s = 0.1;
  double prediction_max_s = 0.5;
  double speed_walk_sd_mps = 0.5;
  double speed_error_max_mps = 0.4;
  double poor_share = 0.55;
  int poor_scans = 3;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("local_map", self.local_map, "Representation of the local map.");
    visit.value("key_scans", self.key_scans, Range{1, 200}, "Number of key scans in the local map.");
    visit.value("key_distance_m", self.key_distance_m, Range{0.0, 10.0},
                "Travel after which a scan becomes a key scan.");
    visit.value("key_rotation_rad", self.key_rotation_rad, Range{0.0, 3.1416},
                "Rotation after which a scan becomes a key scan.");
    visit.value("prediction_max_s", self.prediction_max_s, Range{0.0, 10.0},
                "Time for which the last speed predicts the motion where scans are missing.");
    visit.value("expectation_period_min_s", self.expectation_period_min_s, Range{0.0, 10.0},
                "Shortest time for which accelerations are expected to act, also at higher scan rates.");
    visit.value("speed_walk_sd_mps", self.speed_walk_sd_mps, Range{0.0, 100.0},
                "Standard deviation of the change of speed within 1 s (process noise, a random walk).");
    visit.value("speed_error_max_mps", self.speed_error_max_mps, Range{0.01, 100.0},
                "Upper bound of the speed's standard deviation, for long times without a constraint on it.");
    visit.value(
        "poor_share", self.poor_share, Range{0.0, 1.0},
        "Score of a match, as a share of the usual score, below which it is used only if accelerations allow that "
        "motion: the robot may have been carried.");
    visit.value("poor_scans", self.poor_scans, Range{1, 1000},
                "Number of such matches in a row after which the local map is reset.");
    visit.value("period_min_s", self.period_min_s, Range{0.001, 10.0},
                "Shortest time between two scans; nearer stamps count as this far apart.");
  }
};

/// Tracks the laser by matching each scan to the local map of the last key scans. No prior but constant velocity.
///
/// Memory is fixed at construction. Thread: owned by one thread. Real time: no allocation; one match per scan. After it
/// a key scan's local map is built beside the old one, which serves until then: with what time the match has left
/// before the deadline, or a few slices where there is none, and the next scans go on with it. None of them becomes a
/// key scan meanwhile. Without a deadline it is there at once.
class LaserOdometry {
 public:
  LaserOdometry(const LaserOdometryParams& params, const RobotLimits& limits, const MatcherParams& matcher,
                const ScanParams& scan);

  /// Of the last motion, in the scan's axes; zero before the second scan.
  [[nodiscard]] Velocity2 velocity() const { return {speed_x_mps_, speed_y_mps_, speed_yaw_radps_}; }

  /// Of the next scan, which has been made with room for no more beams than the constructor's `scan`. It is deskewed
  /// here, and so it stays.
  [[nodiscard]] Motion process(ScanFrame& scan, const Deadline& deadline, Rng& rng);

 private:
  static constexpr double kScore_memory_s = 5.0;

  struct KeyScan {
    ScanFrame scan;
    Pose2 odom_T_scan;
  };
  struct LocalMap {
    MatchReference reference;
    Pose2 odom_T_key{};
  };
  struct Estimate {
    Pose2 odom_T_scan;
    ErrorProcess error;
  };
  /// Constant velocity; what may be off of it.
  [[nodiscard]] Estimate predict(double period_s) const;
  [[nodiscard]] MotionReach expected_reach(double period_s) const;
  /// Kalman's update of the prediction by a match. [kalman1960; method 4]
  [[nodiscard]] Estimate corrected(const Estimate& prediction, const Pose2& odom_T_key, const MatchResult& match,
                                   double period_s);
  /// Deskews the scan with the speed of the last motion and matches it; where its match tells another speed, with that,
  /// too. It stays as it fits best.
  [[nodiscard]] Result<MatchResult> match_deskewed(ScanFrame& scan, const Expectation& expected, double period_s,
                                                   const Deadline& deadline, Rng& rng);
  /// Of a step to this scan: the motion from the middle of the sweep before to the middle of this one.
  [[nodiscard]] Pose2 between_middles(const Pose2& step, const ScanFrame& scan) const;
  void remember(const ScanFrame& scan, const Motion& motion, double period_s);
  /// How credible the match is, its other answers, and what is usual.
  void judge(const Result<MatchResult>& match, const Pose2& odom_T_key, double period_s, Motion& motion);
  /// What the local map has slipped by, in the axes of odom; of a match that told the pose.
  [[nodiscard]] Eigen::Matrix2d odom_slip(const Estimate& estimate, const Pose2& odom_T_key, const MatchResult& match);
  /// Whether the local map shall begin anew with this scan.
  [[nodiscard]] bool begins_anew(const Motion& motion);
  /// The speed may be any.
  void forget_speed();
  /// Begins a local map of the key scans, seen from this one, the newest.
  void add_key(const ScanFrame& scan, const Pose2& odom_T_scan);
  void build_map(const Deadline& deadline);

  LaserOdometryParams params_;
  RobotLimits limits_;
  NdtMatcher matcher_;
  LocalMap map_;
  LocalMap next_map_;  ///< being built
  MapSlip slip_;
  std::vector<KeyScan> keys_;
  std::vector<PlacedScan> placed_;
  int key_count_ = 0;
  int newest_key_ = -1;
  bool building_ = false;
  bool started_ = false;
  std::int64_t stamp_ns_ = 0;  ///< of the last scan, as told; its time as estimated
  std::int64_t time_ns_ = 0;
  double time_sd_s_ = 0.0;
  Pose2 odom_T_scan_{};
  double speed_x_mps_ = 0.0, speed_y_mps_ = 0.0, speed_yaw_radps_ = 0.0;
  bool has_speed_ = false;  ///< before the first match it may be any
  Pose2 to_middle_{};       ///< of the last scan, of which the motion was taken out
  int poor_in_a_row_ = 0;
  UsualLevel usual_score_{kScore_memory_s};
  ErrorProcess::Matrix covariance_ = ErrorProcess::Matrix::Zero();  ///< of the error of odom_T_scan_ and the speed
};

}  // namespace odoless
