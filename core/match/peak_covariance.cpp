#include "core/match/peak_covariance.hpp"

#include <algorithm>

#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr double kStray_share = 0.03;      // of the strongest translation's information
constexpr double kInformation_min = 1e-3;  // per point: keeps the covariance of an unconstrained direction finite

}  // namespace

Eigen::Matrix3d peak_covariance(const NdtDerivatives& peak, int points) {
  Eigen::Matrix3d held = peak.held / kPoints_per_fact;
  const math::PrincipalAxes<2> translation = math::principal_axes<2>(held.topLeftCorner<2, 2>());
  const double weak = std::max(0.0, translation.values(0));
  const double stray = kStray_share * std::max(kInformation_min, translation.values(1));
  const Eigen::Vector2d direction = translation.axes.col(0);
  held.topLeftCorner<2, 2>() -=
      weak * stray * stray / (weak * weak + stray * stray) * direction * direction.transpose();
  const math::PrincipalAxes<3> whole = math::principal_axes<3>(held);
  const Eigen::Vector3d information = whole.values.cwiseMax(kInformation_min * points);
  return whole.axes * information.cwiseInverse().asDiagonal() * whole.axes.transpose();
}

}  // namespace odoless
