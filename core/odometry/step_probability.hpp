#pragma once

#include "core/motion/robot_limits.hpp"

namespace odoless {

/// What a match to the local map tells of whether it is right.
struct StepSigns {
  double period_s = 0.0;  ///< since the last scan
  double period_sd_s = 0.0;
  bool matched = false;          ///< false: nothing could be matched, and the prediction stands
  bool is_within_limits = true;  ///< the robot can have moved so by itself
  double score_share = 0.0;      ///< of the match's score in the usual one; 0: no score is usual yet
};

/// Probability that a step of laser odometry is right within 0.5 m and 5 deg.
///
/// Two things speak. How far the robot may have gone meanwhile, against how far a local map reaches: beyond it nothing
/// that the search finds is right. And the match's score: right ones score about as usual, wrong ones about half of it.
/// The constants are of 1700 matches in simulated buildings, after gaps of 0.5 to 12 s; `tools/campaign` says how well
/// they hold.
[[nodiscard]] double step_probability(const RobotLimits& limits, const StepSigns& signs);

}  // namespace odoless
