#pragma once

#include "core/base/deadline.hpp"
#include "core/ndt/ndt.hpp"
#include "core/scan/point_set.hpp"

namespace odoless {

/// The top of a peak of the NDT score.
struct Refined {
  Pose2 reference_T_scan{};
  NdtDerivatives derivatives;  ///< there
  int evaluations = 0;
};

/// Climbs from `start` to the nearest peak of the exact NDT score by damped Newton steps [biber2003ndt, section IV;
/// method 2].
///
/// Where the Hessian is not negative definite its Gauss-Newton part takes its place. Never ends lower than it began.
/// Real time: no allocation; at most `steps` evaluations of score, gradient and Hessian, after the deadline no more
/// than make up the first 4.
[[nodiscard]] Refined refine(const Ndt& ndt, const PointSet& points, const Pose2& start, int steps,
                             const Deadline& deadline = {});

}  // namespace odoless
