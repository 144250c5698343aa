#pragma once

#include <array>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// A pose and what a score says of it.
struct ScoredPose {
  Pose2 pose;
  double score = 0.0;
};

/// Climbs to a better pose by a pattern search [hooke1961direct; method 7]: each round tries a step either way along
/// each axis of the map and in yaw, goes on from the best, and halves the steps when none is better.
///
/// Real time: no allocation; at most 1 + 6 * rounds scores.
/// @param score  Pose2 to double, higher is better; deterministic.
template <class Score>
[[nodiscard]] ScoredPose climb(const Pose2& start, double step_m, double step_rad, int rounds, Score&& score) {
  ScoredPose best{start, score(start)};
  for (int round = 0; round < rounds; ++round) {
    const Pose2 at = best.pose;
    const std::array<Pose2, 6> tries{
        Pose2{at.x_m + step_m, at.y_m, at.yaw_rad}, {at.x_m - step_m, at.y_m, at.yaw_rad},
        {at.x_m, at.y_m + step_m, at.yaw_rad},      {at.x_m, at.y_m - step_m, at.yaw_rad},
        {at.x_m, at.y_m, at.yaw_rad + step_rad},    {at.x_m, at.y_m, at.yaw_rad - step_rad}};
    const double before = best.score;
    for (const Pose2& pose : tries) {
      const double value = score(pose);
      best = value > best.score ? ScoredPose{pose, value} : best;
    }
    if (best.score == before) {
      step_m *= 0.5;
      step_rad *= 0.5;
    }
  }
  return best;
}

}  // namespace odoless
