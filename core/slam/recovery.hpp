#pragma once

#include <cstddef>

#include "core/base/usual_level.hpp"
#include "core/slam/relocaliser.hpp"
#include "core/slam/tracking_monitor.hpp"
#include "core/slam/usual_motion.hpp"

namespace odoless {

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
/// filter without it, bit for bit, but for scans that do not fit and are held.
///
/// Thread:    owned by the filter's thread.
/// Real time: no allocation after construction; one scan's likelihood in the best map while the robot is not lost, in
///            every particle's if it does not fit that; else a slice of the Relocaliser's.
class Recovery {
 public:
  Recovery(const RecoveryParams& params, const ScanParams& scan, const Slam& slam);

  /// A new run begins.
  void reset();
  /// The pose is known: somebody said where the robot is.
  void trust();
  /// What an update of the filter said.
  void note(const UpdateReport& report, int particles);
  /// Every scan after the first, before the filter takes it.
  [[nodiscard]] Advice process(Slam& slam, const TrackedScan& tracked);

  [[nodiscard]] Tracking state() const { return monitor_.state(); }
  [[nodiscard]] bool lost() const { return state() == Tracking::kLost; }
  /// Of the last scan; 1 before the first.
  [[nodiscard]] double fit() const { return last_fit_; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return sizeof(*this) + fit_.memory_bytes() + relocaliser_.memory_bytes();
  }

 private:
  [[nodiscard]] Advice diagnose(Slam& slam, const TrackedScan& tracked);
  [[nodiscard]] double fit_with(Lslam& low, int particle, const Pose2& update_T_scan) const;
  [[nodiscard]] double best_fit(Lslam& low, const Pose2& update_T_scan) const;
  [[nodiscard]] TrackingSigns signs_of(const TrackedScan& tracked) const;
  [[nodiscard]] Advice look_for_it(Slam& slam, const TrackedScan& tracked);
  [[nodiscard]] bool has_waited_enough(const TrackedScan& tracked);

  RecoveryParams params_;
  TrackingMonitor monitor_;
  UsualMotion usual_;
  UsualLevel usual_fit_;
  ScanSpan span_;
  ScanFit fit_;
  Relocaliser relocaliser_;
  double last_fit_ = 1.0;
  double matched_s_ = 0.0;  ///< lost, and every scan has matched the ones before
  int updates_ = 0;
  bool depleted_ = false;
  bool settled_ = false;  ///< lost, and the filter's work is done: the map stays as it is
};

}  // namespace odoless
