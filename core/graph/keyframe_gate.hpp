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
  [[nodiscard]] bool add(const Motion& motion);
  /// The filter has found the robot, or was told where it is: the next scan is wanted, however near.
  void note_found() { is_wanted_ = true; }
  /// Whether the filter is sure of its pose; where that changes the next scan is wanted, too.
  void set_sure(bool is_sure) {
    is_wanted_ |= is_sure != is_sure_;
    is_sure_ = is_sure;
  }
  /// Of the scan that the last motion ended at.
  [[nodiscard]] int beams(const ScanFrame& scan) const {
    return keyframe_beams(scan.size(), params_.keyframe_beams_max);
  }
  void encode(const ScanFrame& scan, const Pose2& map_T_odom, Keyframe& keyframe, std::span<BeamCode> codes) const;
  /// That keyframe has been handed on. Without this the next scan is asked for, and nothing of the motion is lost.
  void accept() { since_last_ = OdometryStretch{}, has_begun_ = true, is_wanted_ = false; }

 private:
  GraphParams params_;
  OdometryStretch since_last_;
  Pose2 odom_T_scan_{};
  bool has_begun_ = false;
  bool is_wanted_ = false;
  bool is_sure_ = true;
};

}  // namespace odoless
