#pragma once

#include <cstddef>
#include <span>

#include "core/graph/graph_params.hpp"
#include "core/graph/keyframe.hpp"
#include "core/motion/motion.hpp"

namespace odoless {

/// Picks keyframes out of the stream of scans, and sums up the motions between them: all that a real-time thread does
/// for the pose graph.
///
/// Thread: owned by one thread. Real time: no allocation, constant time, but for `encode`, linear in the beams.
class KeyframeGate {
 public:
  explicit KeyframeGate(const GraphParams& params) : params_(params) {}

  /// Every motion, with or without its scan. @return  Whether a scan that it ends at should be a keyframe.
  /// @param unknown_s  Over which it says nothing although it is credible by itself: the filter was lost, and has
  ///                   found the robot. 0: it does say it.
  [[nodiscard]] bool add(const Motion& motion, double unknown_s = 0.0);
  /// Of the scan that the last motion ended at.
  [[nodiscard]] int beams(const ScanFrame& scan) const {
    return keyframe_beams(scan.size(), params_.keyframe_beams_max);
  }
  void encode(const ScanFrame& scan, const Pose2& map_T_odom, Keyframe& keyframe, std::span<BeamCode> codes) const;
  /// That keyframe has been handed on. Without this the next scan is asked for, and nothing of the motion is lost.
  void accept() { since_last_ = OdometryStretch{}, has_begun_ = true; }

 private:
  GraphParams params_;
  OdometryStretch since_last_;
  Pose2 odom_T_scan_{};
  bool has_begun_ = false;
};

}  // namespace odoless
