#include "core/slam/pose_confidence.hpp"

#include <algorithm>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kLeast = 1e-9;            // no state is ever impossible
constexpr double kJump_shows_in_s = 60.0;  // a jump that the scans have not contradicted for longer was none
constexpr double kAt_rest_s = 2.0;         // after which a scan that fits counts as a new one
constexpr double kAgainst = 3.0;           // a third of the way makes one that does not fit a new one

}  // namespace

void PoseConfidence::find() {
  right_ = params_.found_probability;
  drifted_ = 0.0;
  jumped_ = wrong_step_ = 1.0 - right_;
}

void PoseConfidence::confirm() {
  right_ *= math::exp(params_.nowhere_else);
  normalise();
}

void PoseConfidence::contradict() {
  right_ *= math::exp(-params_.elsewhere);
  drifted_ *= math::exp(-params_.elsewhere);
  normalise();
}

void PoseConfidence::lose_track() {
  right_ = 0.5;
  drifted_ = 0.5;
  jumped_ = 0.0;
}

void PoseConfidence::move(double step_probability, double travel_m, double period_s) {
  const double wrong = 1.0 - std::clamp(step_probability, 0.0, 1.0);
  wrong_step_ *= std::max(0.0, 1.0 - std::max(0.0, period_s) / kJump_shows_in_s);
  wrong_step_ += wrong * (1.0 - wrong_step_);
  const double drifting = std::min(1.0, params_.drift_per_m * travel_m) * right_;
  const double mending = std::min(1.0, params_.mend_per_s * period_s) * drifted_;
  right_ += mending - drifting;
  drifted_ += drifting - mending;
  jumped_ += wrong * (right_ + drifted_);
  right_ *= 1.0 - wrong;
  drifted_ *= 1.0 - wrong;
  normalise();
}

void PoseConfidence::slip(double within) {
  drifted_ += (1.0 - within) * right_;
  right_ *= within;
  normalise();
}

void PoseConfidence::observe(double fit_share, double known_share, double span_s, double moved) {
  const double against = std::max(-params_.against_max, params_.evidence_per_fit * (fit_share - params_.against_fit));
  const double in_favour = std::min(params_.for_max, params_.evidence_per_fit * (fit_share - params_.for_fit));
  const double evidence = std::min(0.0, against) + std::max(0.0, in_favour);
  // From the same place a scan says the same again: that it fits is confirmed by looking longer, but slowly; where it
  // does not, the map may be wrong there.
  const double counts = evidence > 0.0 ? std::min(1.0, moved + span_s / kAt_rest_s)
                                       : std::min({1.0, span_s / params_.evidence_period_s, kAgainst * moved});
  const double weight = known_share * counts;
  right_ *= math::exp(weight * evidence);
  normalise();
}

void PoseConfidence::normalise() {
  right_ = std::max(right_, kLeast);
  drifted_ = std::max(drifted_, kLeast);
  jumped_ = std::max(jumped_, kLeast);
  const double sum = right_ + drifted_ + jumped_;
  right_ /= sum;
  drifted_ /= sum;
  jumped_ /= sum;
}

}  // namespace odoless
