#include "core/odometry/step_probability.hpp"

#include <algorithm>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kLocal_map_m = 8.0;    // way at full speed after which two of three robots have left it
constexpr double kLeft_max = 0.97;      // it may as well have stood still
constexpr double kNeutral_share = 0.7;  // of the usual score, that right and wrong matches have alike often
constexpr double kEvidence_per_share = 12.0;
constexpr double kPoor_share = 0.5;  // below it the robot may have been carried, however short the time was
constexpr double kPoor_carried = 0.003;
constexpr double kCarried = 0.5;  // that a robot which was carried is not where its local map reaches
constexpr double kEvidence_min = -2.5;
constexpr double kEvidence_max = 5.0;

// A robot seldom goes straight on at full speed: in a short time hardly any leaves, in a long one nearly all do.
double probability_of_leaving(const RobotLimits& limits, const StepSigns& signs) {
  const double way = limits.speed_max_mps * (signs.period_s + 0.5 * signs.period_sd_s) / kLocal_map_m;
  return -kLeft_max * math::expm1(-(way * way * way * way));
}

// Natural logarithm of how much oftener right matches have this score than wrong ones.
double evidence_of(const StepSigns& signs) {
  if (!signs.matched || signs.score_share <= 0.0) {
    return 0.0;
  }
  return std::clamp(kEvidence_per_share * (signs.score_share - kNeutral_share), kEvidence_min, kEvidence_max);
}

}  // namespace

double step_probability(const RobotLimits& limits, const StepSigns& signs) {
  const bool is_poor = signs.matched && signs.score_share > 0.0 && signs.score_share < kPoor_share;
  const double carried = !signs.is_within_limits ? kCarried : is_poor ? kPoor_carried : 0.0;
  const double left = std::max(probability_of_leaving(limits, signs), carried);
  const double stayed = (1.0 - left) * math::exp(evidence_of(signs));
  return stayed / (stayed + left);
}

}  // namespace odoless
