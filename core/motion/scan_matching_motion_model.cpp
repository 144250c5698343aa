#include "core/motion/scan_matching_motion_model.hpp"

#include <cmath>

#include "core/base/check.hpp"

namespace odoless {
namespace {

/// Table 5.2. The sum of 12 uniforms of [-1, 1) has variance 4, so the deviation is v / 3.
double sample_a(double v, Rng& rng) {
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) {
    sum += rng.uniform(-1.0, 1.0);
  }
  return v / 6.0 * sum;
}

}  // namespace

ScanMatchingMotionModel::ScanMatchingMotionModel(const MotionModelParams& params) : params_(params) {
  ODOLESS_CHECK(parameters_in_range(params));
}

Pose2 ScanMatchingMotionModel::sample(const Pose2& map_T_previous, const Pose2& increment, double lambda_m,
                                      Rng& rng) const {
  const auto translation_spread_m = [this](double travel_m) {
    return params_.translation_spread_m + params_.translation_spread_ratio * std::abs(travel_m);
  };
  const double rotation_rad = std::abs(increment.yaw_rad);
  const double rotation_spread_rad = params_.rotation_spread_rad + params_.rotation_spread_ratio * rotation_rad;

  // The order of the draws is the table's: sideways, along the heading, rotation.
  const double left_m = increment.y_m - sample_a(translation_spread_m(increment.y_m), rng);
  const bool slipped = rng.uniform() > 1.0 - params_.slip_probability && rotation_rad < params_.slip_rotation_max_rad;
  const double forward_noise_m =
      slipped ? lambda_m + sample_a(lambda_m / 2.0, rng) : sample_a(translation_spread_m(increment.x_m), rng);
  const double yaw_rad = increment.yaw_rad + sample_a(rotation_spread_rad, rng);

  // Lines 4 to 8: the table turns (dx, dy) by the heading less 90 degrees, which is to turn (dy, -dx) by the heading.
  return map_T_previous * Pose2{increment.x_m + forward_noise_m, left_m, yaw_rad};
}

}  // namespace odoless
