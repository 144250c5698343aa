#include "core/odometry/map_slip.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr double kHeld_m = 0.1;    // deviation of a match below which older scans hold the pose in every direction
constexpr double kLeast_m = 0.01;  // less is what the scans of a map err by each

}  // namespace

// That weak matches agree is no mending: they say the same wrong thing scan after scan. So the largest error counts.
Eigen::Matrix2d MapSlip::match(const Eigen::Matrix2d& held, const Eigen::Matrix2d& error) {
  const Key key = std::exchange(map_, Key{});
  Eigen::Matrix2d slip = Eigen::Matrix2d::Zero();
  if (key.error.trace() >= kLeast_m * kLeast_m) {
    const math::PrincipalAxes<2> before = math::principal_axes<2>(key.held);
    const Eigen::Vector2d weak = before.axes.col(1);
    const double still_held = std::min(1.0, weak.dot(held * weak) / before.values(1));
    const double slip_m = (1.0 - still_held) * std::sqrt(weak.dot(key.error * weak));
    if (slip_m >= kLeast_m) {
      slip = slip_m * slip_m * weak * weak.transpose();
      newest_.error.setZero();
    }
  }
  newest_.held = held;
  if (math::principal_axes<2>(held).values(1) < kHeld_m * kHeld_m || error.trace() > newest_.error.trace()) {
    newest_.error = error;
  }
  return slip;
}

}  // namespace odoless
