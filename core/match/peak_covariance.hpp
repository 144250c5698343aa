#pragma once

#include <Eigen/Core>

#include "core/ndt/ndt.hpp"

namespace odoless {

/// Neighbouring points err together, the same wall, the same cell: so many count as one.
inline constexpr double kPoints_per_fact = 5.0;

/// Covariance of a match at a peak of the NDT score, over (x_m, y_m, yaw_rad) in the reference's axes: the inverse of
/// what the walls constrain. The less constrained translation is believed the less, the smaller a share of the other
/// one's information it has: down there stray points speak, and say the same wrong thing scan after scan.
///
/// @param points  Points that the derivatives are of.
[[nodiscard]] Eigen::Matrix3d peak_covariance(const NdtDerivatives& peak, int points);

}  // namespace odoless
