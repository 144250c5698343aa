#include "tools/experiment/measures.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {

double DisplacementError::translation_m() const { return std::hypot(x_m, y_m); }

std::vector<DisplacementError> displacement_errors(std::span<const MatchRow> matches,
                                                   std::span<const ReferencePose> poses) {
  std::vector<DisplacementError> errors;
  for (const MatchRow& match : matches) {
    const Pose2& before = poses[static_cast<std::size_t>(match.reference_index)].pose;
    const Pose2 true_motion = before.inverse() * poses[static_cast<std::size_t>(match.index)].pose;
    const Pose2& found = match.reference_T_scan;
    errors.push_back({.index = match.index,
                      .x_m = true_motion.y_m - found.y_m,
                      .y_m = found.x_m - true_motion.x_m,
                      .yaw_rad = wrap_angle(found.yaw_rad - true_motion.yaw_rad),
                      .true_motion = true_motion});
  }
  return errors;
}

std::vector<Pose2> chain(std::span<const MatchRow> matches, const Pose2& start) {
  std::vector<Pose2> poses{start};
  for (const MatchRow& match : matches) {
    poses.push_back(poses.back() * match.reference_T_scan);
  }
  return poses;
}

std::vector<Pose2> placed(std::span<const ReferencePose> trajectory, const Pose2& world_T_start) {
  const Pose2 world_T_map = world_T_start * trajectory.front().pose.inverse();
  std::vector<Pose2> poses;
  for (const ReferencePose& pose : trajectory) {
    poses.push_back(world_T_map * pose.pose);
  }
  return poses;
}

std::vector<double> position_errors_m(std::span<const Pose2> poses, std::span<const ReferencePose> truth) {
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < std::min(poses.size(), truth.size()); ++i) {
    errors_m.push_back(poses[i].distance_m(truth[i].pose));
  }
  return errors_m;
}

MatchingSummary summarise_matching(const std::string& label, const ReferencePoses& truth,
                                   std::span<const MatchRow> matches) {
  const PairsResult result = evaluate_pairs(truth, matches, {});
  return {.label = label,
          .pairs = result.used,
          .gross = result.gross,
          .median_m = result.errors.translation_m.median,
          .median_rad = result.errors.rotation_rad.median,
          .rms_m = result.errors.translation_m.root_mean_square,
          .max_m = result.errors.translation_m.max,
          .time_median_us = result.time_us.median};
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(share * last))];
}

RobustNormal fit_normal(const std::vector<double>& values) {
  constexpr double kDeviationPerMedianDistance = 1.4826;
  const double median = quantile(values, 0.5);
  std::vector<double> off_median;
  for (const double value : values) {
    off_median.push_back(std::abs(value - median));
  }
  return {median, kDeviationPerMedianDistance * quantile(off_median, 0.5)};
}

}  // namespace odoless
