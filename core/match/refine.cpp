#include "core/match/refine.hpp"

#include <Eigen/Cholesky>

namespace odoless {
namespace {

constexpr double kDamping_first = 1e-3;
constexpr double kConverged_m = 1e-5;
constexpr int kSteps_sure = 4;  // from a simplex's answer hardly any is left after them

// Steepest safe step: Newton's where the score is concave, Gauss-Newton's elsewhere.
Eigen::Vector3d ascent_step(const NdtDerivatives& at, double damping) {
  const auto damped = [&](Eigen::Matrix3d m) {
    m.diagonal() *= 1.0 + damping;
    m.diagonal().array() += 1e-6;
    return m;
  };
  const Eigen::LLT<Eigen::Matrix3d> newton(damped(-at.hessian));
  if (newton.info() == Eigen::Success) {
    return newton.solve(at.gradient);
  }
  return Eigen::LLT<Eigen::Matrix3d>(damped(at.gauss_newton)).solve(at.gradient);
}

}  // namespace

Refined refine(const Ndt& ndt, const PointSet& points, const Pose2& start, int steps, const Deadline& deadline) {
  Refined best{start, ndt.derivatives(points, start), 1};
  double damping = kDamping_first;
  while (best.evaluations < steps && (best.evaluations < kSteps_sure || !deadline.expired())) {
    const Eigen::Vector3d step = ascent_step(best.derivatives, damping);
    const Pose2& at = best.reference_T_scan;
    const Pose2 next{at.x_m + step.x(), at.y_m + step.y(), wrap_angle(at.yaw_rad + step.z())};
    const NdtDerivatives derivatives = ndt.derivatives(points, next);
    ++best.evaluations;
    if (derivatives.score < best.derivatives.score) {
      damping = damping * 10.0 + 0.1;
      continue;
    }
    best.reference_T_scan = next;
    best.derivatives = derivatives;
    damping *= 0.1;
    if (step.norm() < kConverged_m) {
      break;
    }
  }
  return best;
}

}  // namespace odoless
