#include "core/match/ndt_matcher.hpp"

#include <algorithm>

#include "core/match/peak_covariance.hpp"
#include "core/math/elementary.hpp"
#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr int kReturns_min = 8;
constexpr int kProbe_steps = 30;
constexpr int kRest_steps = 60;

}  // namespace

MatcherParams seed_matcher_params() {
  MatcherParams params;
  params.reference.ndt.cell_size_m = 1.0;
  params.reference.thinning_m = 0.0;
  params.reference.free_penalty = 0.0;
  params.search.start_points = 100;
  params.search.expected_share = 0.0;
  params.search.coarse_evaluations = 0;
  params.search.fine_evaluations = 5000;
  params.search.exact = true;
  params.search.angle_floor = 1.0;
  params.search.simplex_steps = 0;
  params.probe_m = 0.0;
  params.search.de = {.population = 100, .strategy = DeStrategy::kRand1Bin};
  params.refine_steps = 1;
  params.score_min = 0.0;
  params.prior_weight = 0.0;
  return params;
}

Expectation expect_rest(const RobotLimits& limits, double period_s) {
  const double half_s = 0.5 * std::max(0.0, period_s);
  return {Pose2{}, limits.speed_max_mps * half_s, limits.turn_rate_max_radps * half_s};
}

NdtMatcher::NdtMatcher(const MatcherParams& params)
    : params_(params),
      scan_{PointSet(params.points_max), {}},
      returns_(params.points_max),
      search_(params.search, params.points_max),
      retry_(params.retry, params.points_max) {
  ODOLESS_CHECK(parameters_in_range(params));
}

Result<MatchResult> NdtMatcher::match(MatchReference& reference, const ScanFrame& scan, const Expectation& expected,
                                      const Deadline& deadline, Rng& rng) {
  if (reference.empty()) {
    return Errc::kNoReference;
  }
  if (scan.returns() < kReturns_min) {
    return Errc::kTooFewReturns;
  }
  if (scan.returns() > params_.points_max) {
    return Errc::kTooManyBeams;
  }
  scan_.points.clear();
  returns_.clear();
  scan_.orientations.clear();
  append_thinned(scan, {}, params_.reference.thinning_m, scan_.points);
  append_thinned(scan, {}, 0.0, returns_);
  scan_.orientations.add(scan, 0.0, params_.reference.thinning_m);
  scan_.orientations.smooth();

  MatchResult result;
  const MotionPrior prior{expected.reference_T_scan, expected.sd_m, expected.sd_rad, params_.prior_weight};
  result.escalated = expected.is_wide;
  const SearchGround ground{reference.coarse(),    reference.fine(), reference.orientations(), prior,
                            reference.exact_ndt(), deadline};
  SearchOutcome outcome = search(ground, reference, rng, result);
  if (expected.is_wide) {
    const SearchPoint rest = to_search_point(expected.rest_T_scan);
    outcome.peaks.offer(PoseSearch::climb(ground, scan_.points, rest, kRest_steps, outcome.evaluations));
  }
  climb(ground, outcome, result);
  const double before = outcome.peaks.best().score;
  probe(ground, outcome, result.weak_direction);
  if (outcome.peaks.best().score > before) {
    climb(ground, outcome, result);
  }
  result.score = outcome.peaks.best().score;
  result.evaluations += outcome.evaluations;
  result.stop = deadline.expired() ? StopReason::kDeadline : outcome.stop;
  weigh(outcome.peaks, result);
  result.converged = !is_poor(outcome) && result.second_peak_ratio() <= params_.second_peak_ratio_max;
  return result;
}

SearchOutcome NdtMatcher::search(const SearchGround& ground, MatchReference& reference, Rng& rng, MatchResult& result) {
  SearchOutcome first = search_.run(ground, scan_, rng);
  // What has climbed out of the box is one of the answers out there, and not the best of them for sure.
  const bool is_enough = !result.escalated && !is_poor(first) && search_.box().holds(first.peaks.best().point);
  if (is_enough || ground.deadline.expired() || !reference.prepare_wide(ground.deadline)) {
    return first;
  }
  result.escalated = true;
  const SearchGround wide{reference.wide(), ground.fine,      ground.reference_orientations,
                          ground.prior,     ground.exact_ndt, ground.deadline};
  SearchOutcome again = retry_.run(wide, scan_, rng);
  again.evaluations += first.evaluations;
  for (const ScoredPoint& peak : first.peaks.all()) {
    again.peaks.offer(peak);
  }
  return again;
}

void NdtMatcher::probe(const SearchGround& ground, SearchOutcome& outcome, Point2 direction) const {
  if (params_.probe_m == 0.0 || ground.deadline.expired()) {
    return;
  }
  const SearchPoint best = outcome.peaks.best().point;
  for (const double sign : {-1.0, 1.0}) {
    SearchPoint start = best;
    start[0] += sign * params_.probe_m * direction.x_m;
    start[1] += sign * params_.probe_m * direction.y_m;
    outcome.peaks.offer(PoseSearch::climb(ground, scan_.points, start, kProbe_steps, outcome.evaluations));
  }
}

// Neighbouring points err together, so a scan tells fewer facts than it has points.
void NdtMatcher::weigh(const Peaks& peaks, MatchResult& result) const {
  const double facts = scan_.points.size() / kPoints_per_fact;
  double sum = 0.0;
  for (const ScoredPoint& peak : peaks.all()) {
    MatchPeak& out = result.peaks[static_cast<std::size_t>(result.peak_count++)];
    out = {to_pose(peak.point), peak.score, math::exp(facts * (peak.score - peaks.best().score))};
    sum += out.weight;
  }
  for (MatchPeak& peak : result.peaks) {
    peak.weight /= sum;
  }
  result.peaks[0].reference_T_scan = result.reference_T_scan;
}

void NdtMatcher::climb(const SearchGround& ground, const SearchOutcome& outcome, MatchResult& result) const {
  const Refined top =
      refine(ground.exact_ndt, returns_, to_pose(outcome.peaks.best().point), params_.refine_steps, ground.deadline);
  result.reference_T_scan = top.reference_T_scan;
  result.evaluations += top.evaluations;
  result.fitness = top.derivatives.score / returns_.size();
  result.covariance = peak_covariance(top.derivatives, returns_.size());
  const math::PrincipalAxes<2> held = math::principal_axes<2>(-top.derivatives.hessian.topLeftCorner<2, 2>());
  result.weak_direction = {held.axes(0, 0), held.axes(1, 0)};
  result.weak_information_1_m2 = held.values(0) / returns_.size();
  result.strong_information_1_m2 = held.values(1) / returns_.size();
}

}  // namespace odoless
