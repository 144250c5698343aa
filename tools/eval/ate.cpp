#include "tools/eval/ate.hpp"

namespace odoless {
namespace {

struct Centres {
  Point2 reference;
  Point2 estimate;
};

Centres find_centres(std::span<const PosePair> pairs) {
  Centres centres;
  const auto n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    centres.reference.x_m += pair.reference.x_m / n;
    centres.reference.y_m += pair.reference.y_m / n;
    centres.estimate.x_m += pair.estimate.x_m / n;
    centres.estimate.y_m += pair.estimate.y_m / n;
  }
  return centres;
}

}  // namespace

Pose2 align(std::span<const PosePair> pairs) {
  const Centres centres = find_centres(pairs);
  double dot_m2 = 0.0;
  double cross_m2 = 0.0;
  for (const PosePair& pair : pairs) {
    const double rx = pair.reference.x_m - centres.reference.x_m;
    const double ry = pair.reference.y_m - centres.reference.y_m;
    const double ex = pair.estimate.x_m - centres.estimate.x_m;
    const double ey = pair.estimate.y_m - centres.estimate.y_m;
    dot_m2 += ex * rx + ey * ry;
    cross_m2 += ex * ry - ey * rx;
  }
  const Pose2 turn{0.0, 0.0, std::atan2(cross_m2, dot_m2)};
  const Point2 turned = turn * centres.estimate;
  return {centres.reference.x_m - turned.x_m, centres.reference.y_m - turned.y_m, turn.yaw_rad};
}

AteResult evaluate_ate(std::span<const ReferencePose> reference, std::span<const ReferencePose> estimate,
                       const Association& association) {
  const StampLookup lookup(reference);
  const Pose2 laser_T_robot{-association.laser_x_m, 0.0, 0.0};
  std::vector<PosePair> pairs;
  for (const ReferencePose& pose : estimate) {
    if (const auto found = lookup.nearest(pose.stamp_s, association.tolerance_s)) {
      pairs.push_back({*found, pose.pose * laser_T_robot});
    }
  }
  AteResult result;
  result.missing = estimate.size() - pairs.size();
  if (pairs.size() < 2) {
    return result;
  }
  result.used = pairs.size();
  result.reference_T_estimate = align(pairs);
  std::vector<PoseError> errors;
  errors.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    errors.push_back(pose_error(pair.reference, result.reference_T_estimate * pair.estimate));
  }
  result.errors = summarise(errors);
  return result;
}

}  // namespace odoless
