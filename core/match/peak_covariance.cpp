#include "core/match/peak_covariance.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace odoless {
namespace {

constexpr double kStray_share = 0.03;      // of the strongest translation's information
constexpr double kInformation_min = 1e-3;  // per point: keeps the covariance of an unconstrained direction finite

}  // namespace

Eigen::Matrix3d peak_covariance(const NdtDerivatives& peak, int points) {
  Eigen::Matrix3d held = peak.held / kPoints_per_fact;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> translation(held.topLeftCorner<2, 2>());
  const double weak = std::max(0.0, translation.eigenvalues()(0));
  const double stray = kStray_share * std::max(kInformation_min, translation.eigenvalues()(1));
  const Eigen::Vector2d direction = translation.eigenvectors().col(0);
  held.topLeftCorner<2, 2>() -=
      weak * stray * stray / (weak * weak + stray * stray) * direction * direction.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(held);
  const Eigen::Vector3d information = axes.eigenvalues().cwiseMax(kInformation_min * points);
  return axes.eigenvectors() * information.cwiseInverse().asDiagonal() * axes.eigenvectors().transpose();
}

}  // namespace odoless
