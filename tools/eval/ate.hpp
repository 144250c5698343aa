#pragma once

#include <span>

#include "tools/eval/pose_errors.hpp"
#include "tools/eval/stamp_lookup.hpp"

namespace odoless {

struct AteResult {
  Pose2 reference_T_estimate;  ///< the motion of the whole estimate that fits it to the reference
  PoseErrorStatistics errors;  ///< of every pose after that motion
  std::size_t used = 0;
  std::size_t missing = 0;  ///< poses of the estimate that the reference has no pose for
};

/// A pose of the reference and the estimate's pose of the same time.
struct PosePair {
  Pose2 reference;
  Pose2 estimate;
};

/// The motion that brings the estimates' places nearest to the references' in the sense of least squares, in closed
/// form [umeyama1991least, eq. 40 and 41, in the plane and without scale]. The identity for no pair.
[[nodiscard]] Pose2 align(std::span<const PosePair> pairs);

/// Absolute trajectory error: associates by stamp, aligns, measures [sturm2012benchmark, sec. VI-A].
/// With fewer than 2 pairs nothing is measured: used = 0.
[[nodiscard]] AteResult evaluate_ate(std::span<const ReferencePose> reference, std::span<const ReferencePose> estimate,
                                     const Association& association);

}  // namespace odoless
