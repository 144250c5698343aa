#include "tools/experiment/motion_claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/motion/scan_matching_motion_model.hpp"
#include "tools/eval/report.hpp"

namespace odoless {
namespace {

double median_absolute(std::span<const DisplacementError> errors, double DisplacementError::*member) {
  std::vector<double> absolutes;
  for (const DisplacementError& error : errors) {
    absolutes.push_back(std::abs(error.*member));
  }
  return quantile(absolutes, 0.5);
}

/// Whether the dissertation's spread law v = floor + ratio * d, whose deviation is v / 3, is nowhere below the fitted
/// one, up to a displacement of `largest`.
bool is_covered(const SpreadLaw& fitted, double spread_floor, double spread_ratio, double largest) {
  constexpr double kSpreadPerDeviation = 3.0;
  const auto is_covered_at = [&](double moved) {
    return kSpreadPerDeviation * (fitted.floor + fitted.ratio * moved) <= spread_floor + spread_ratio * moved;
  };
  return is_covered_at(0.0) && is_covered_at(largest);
}

}  // namespace

SpreadLaw fit_spread(std::span<const double> displacements, std::span<const double> errors) {
  const double mean_per_deviation = std::sqrt(2.0 / std::numbers::pi);
  const auto n = static_cast<double>(displacements.size());
  double sum_d = 0.0;
  double sum_s = 0.0;
  double sum_dd = 0.0;
  double sum_ds = 0.0;
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    const double d = std::abs(displacements[i]);
    const double s = std::abs(errors[i]) / mean_per_deviation;
    sum_d += d;
    sum_s += s;
    sum_dd += d * d;
    sum_ds += d * s;
  }
  const double divisor = n * sum_dd - sum_d * sum_d;
  const double ratio = divisor > 0.0 ? (n * sum_ds - sum_d * sum_s) / divisor : 0.0;
  return {n > 0.0 ? (sum_s - ratio * sum_d) / n : 0.0, ratio};
}

Claim errors_look_normal(const char* figure, const char* axis, std::span<const double> errors) {
  constexpr double kDeviations = 2.0;
  constexpr double kShareMin = 0.90;
  constexpr double kShareMax = 0.99;
  const RobustNormal law = fit_normal({errors.begin(), errors.end()});
  const auto inside = std::count_if(errors.begin(), errors.end(), [&](double error) {
    return std::abs(error - law.mean) <= kDeviations * law.deviation;
  });
  const double share = static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(1, errors.size()));
  return {figure, fmt::format("the errors of {} are distributed as a Gaussian", axis),
          fmt::format("mean {:.2g}, sd {:.2g}; {:.1f} % within 2 sd (a Gaussian: 95.4 %)", law.mean, law.deviation,
                      100.0 * share),
          share >= kShareMin && share <= kShareMax};
}

Claim spreads_cover_errors(std::span<const DisplacementError> errors) {
  std::vector<double> forward_m;
  std::vector<double> forward_errors_m;
  std::vector<double> turned_rad;
  std::vector<double> turn_errors_rad;
  double longest_m = 0.0;
  double widest_rad = 0.0;
  for (const DisplacementError& error : errors) {
    forward_m.push_back(error.true_motion.x_m);
    forward_errors_m.push_back(error.y_m);
    turned_rad.push_back(error.true_motion.yaw_rad);
    turn_errors_rad.push_back(error.yaw_rad);
    longest_m = std::max(longest_m, std::abs(error.true_motion.x_m));
    widest_rad = std::max(widest_rad, std::abs(error.true_motion.yaw_rad));
  }
  const SpreadLaw forward = fit_spread(forward_m, forward_errors_m);
  const SpreadLaw turn = fit_spread(turned_rad, turn_errors_rad);
  const MotionModelParams seed;
  return {"5.19", "spreads of 0.02 m + |dy| / 10 and 0.5 deg + |dtheta| / 10 describe the errors",
          fmt::format(
              "fitted standard deviations {:.1f} mm + {:.4f} |dy| and {:.3f} deg + {:.4f} |dtheta|; the dissertation's "
              "spreads are 3 "
              "deviations",
              forward.floor * 1e3, forward.ratio, to_deg(turn.floor), turn.ratio),
          is_covered(forward, seed.translation_spread_m, seed.translation_spread_ratio, longest_m) &&
              is_covered(turn, seed.rotation_spread_rad, seed.rotation_spread_ratio, widest_rad)};
}

Claim long_displacements_turn_little(std::span<const MatchRow> matches) {
  constexpr double kLongFrom = 0.75;
  std::vector<double> travels_m;
  std::vector<double> turns_rad;
  for (const MatchRow& match : matches) {
    travels_m.push_back(match.reference_T_scan.x_m);
    turns_rad.push_back(std::abs(match.reference_T_scan.yaw_rad));
  }
  const double long_m = quantile(travels_m, kLongFrom);
  std::vector<double> long_turns_rad;
  for (std::size_t i = 0; i < travels_m.size(); ++i) {
    if (travels_m[i] >= long_m) {
      long_turns_rad.push_back(turns_rad[i]);
    }
  }
  const double all_deg = to_deg(quantile(turns_rad, 0.5));
  const double long_deg = to_deg(quantile(long_turns_rad, 0.5));
  return {"5.23", "large displacements along the heading correspond to small rotations",
          fmt::format("median rotation {:.2f} deg of the quarter with {:.2f} m and more, {:.2f} deg of all", long_deg,
                      long_m, all_deg),
          long_deg < all_deg};
}

Claim corridor_hides_travel(std::span<const DisplacementError> errors) {
  std::vector<double> shares;
  for (const DisplacementError& error : errors) {
    if (error.true_motion.x_m > 0.0) {
      shares.push_back((error.true_motion.x_m + error.y_m) / error.true_motion.x_m);
    }
  }
  const double share = quantile(shares, 0.5);
  return {"5.21", "along a featureless wall the match gives near zero travel or much less than there was",
          fmt::format("median {:.0f} % of the true travel", 100.0 * share), !shares.empty() && share < 0.5};
}

Claim corridor_holds_across(std::span<const DisplacementError> errors) {
  constexpr double kAcrossMaxM = 0.02;
  const double across_m = median_absolute(errors, &DisplacementError::x_m);
  const double yaw_deg = to_deg(median_absolute(errors, &DisplacementError::yaw_rad));
  return {"5.21", "the most common error is in delta y, not across or in rotation",
          fmt::format("median error across {:.1f} mm, along {:.1f} mm, {:.2f} deg", across_m * 1e3,
                      1e3 * median_absolute(errors, &DisplacementError::y_m), yaw_deg),
          across_m <= kAcrossMaxM && across_m < median_absolute(errors, &DisplacementError::y_m)};
}

}  // namespace odoless
