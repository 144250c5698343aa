#pragma once

#include <cstddef>

#include "core/base/usual_level.hpp"
#include "core/slam/pose_confidence.hpp"
#include "core/slam/relocaliser.hpp"
#include "core/slam/usual_motion.hpp"

namespace odoless {

/// What the filter takes its pose for.
enum class Tracking : std::uint8_t {
  kSure,      ///< right within 0.5 m and 5 deg, with the probability that the configuration asks for
  kDoubtful,  ///< less probable than that
  kLost       ///< tracking broke off: the pose in the map is not known
};

/// A scan as the tracking has it.
struct TrackedScan {
  const ScanFrame& scan;
  Pose2 update_T_scan;   ///< from the filter's last update to the scan
  const Motion& motion;  ///< from the last scan that was processed to this one
};

/// What to do with a scan.
enum class Advice : std::uint8_t {
  kGoOn,
  kHold,  ///< it must not be mapped
  kFound  ///< the particles have been put where the robot was found: take this scan from there
};

/// The filter's self-diagnosis, and its way back when it is lost. While the robot is lost nothing may be mapped.
///
/// It draws nothing and changes nothing of the filter unless the robot is lost: without that, results are those of a
/// filter without it, bit for bit, but for scans that are held.
///
/// Thread:    owned by the filter's thread.
/// Real time: no allocation after construction; a scan's likelihood in the best map while the robot is not lost, in
///            every particle's if it does not fit that; else a slice of the Relocaliser's.
class Recovery {
 public:
  Recovery(const RecoveryParams& params, const ScanParams& scan, const Slam& slam);

  /// A new run begins.
  void reset();
  /// The pose is known: somebody said where the robot is.
  void trust();
  /// The filter was updated, with a motion that is within what OK allows with this probability.
  void note_update(double within);
  /// Every scan after the first, before the filter takes it.
  [[nodiscard]] Advice process(Slam& slam, const TrackedScan& tracked);

  /// @param agreement  PoseEstimate's: less where the particles do not agree on one pose.
  [[nodiscard]] Tracking state(double agreement = 1.0) const;
  [[nodiscard]] bool lost() const { return lost_; }
  /// That the pose is right within 0.5 m and 5 deg, as far as the scans tell.
  [[nodiscard]] double probability() const { return lost_ ? 0.0 : confidence_.right(); }
  /// Where with the last scan the robot was found: the time since its pose was last sure, of which nobody knows where
  /// it was. Else 0.
  [[nodiscard]] double unknown_s() const { return unknown_s_; }
  /// Not 0 where the robot was lost and went on without being found, so that nobody knows how what it maps lies to the
  /// rest: how often that was so.
  [[nodiscard]] int unconfirmed() const { return unconfirmed_ ? resumptions_ : 0; }
  /// Whether a step of about the last minute may have been wrong, so that the robot may be where the steps do not lead.
  [[nodiscard]] bool may_be_elsewhere() const;
  /// Of the last scan; 1 before the first.
  [[nodiscard]] double fit() const { return last_fit_.mean; }

 private:
  static constexpr double kFit_memory_s = 60.0;  ///< longer than a wrong pose may take to show

  [[nodiscard]] Advice follow(Slam& slam, const TrackedScan& tracked);
  [[nodiscard]] Advice diagnose(Slam& slam, const TrackedScan& tracked);
  /// In the best particle's map; in that which it fits best where it does not fit.
  [[nodiscard]] Fit fit_of(Lslam& low, const Pose2& update_T_scan) const;
  [[nodiscard]] bool may_be_mapped() const;
  void lose();
  [[nodiscard]] Advice look_for_it(Slam& slam, const TrackedScan& tracked);
  [[nodiscard]] bool is_suspect(const Motion& motion) const;
  /// A slice of the search for another place that fits better than where the robot is taken to be.
  void verify(Slam& slam, const TrackedScan& tracked);
  void find_at(Slam& slam, const Pose2& map_T_scan);
  [[nodiscard]] bool has_waited_enough(const TrackedScan& tracked);

  RecoveryParams params_;
  PoseConfidence confidence_;
  UsualMotion usual_;
  UsualLevel usual_fit_{kFit_memory_s};
  ScanSpan span_;
  ScanFit fit_;
  Relocaliser relocaliser_;
  Fit last_fit_;
  double unsure_s_ = 0.0;   ///< since the pose was last sure
  double unknown_s_ = 0.0;  ///< of it, with the last scan
  double matched_s_ = 0.0;  ///< lost, and every scan has matched the ones before
  int updates_ = 0;
  int resumptions_ = 0;
  bool lost_ = false;
  bool suspected_ = false;    ///< a step may have been wrong, and the map has not yet shown that no other place fits
  bool unconfirmed_ = false;  ///< it was lost, and went on without being found
  bool settled_ = false;      ///< lost, and the filter's work is done: the map stays as it is
};

}  // namespace odoless
