#include "core/graph/submap_graph.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/pose2_covariance.hpp"

namespace odoless {
namespace {

constexpr double kDeviations = 3.0;
constexpr int kRevisited = 2;  // older submaps that are looked at again with each new one
constexpr int kRevisited_candidates = 6;
constexpr double kRevisited_sd_m = 0.5;
constexpr double kSlack_m = 0.5;  // of the search beyond the deviations
constexpr double kSlack_rad = 0.05;
constexpr double kSearch_max_m = 7.0;
constexpr double kSearch_max_rad = 0.61;
constexpr double kLostYaw_rad = 0.5;  // deviation of the yaw from which on all is searched
constexpr double kLostSearch_rad = 2.1;
constexpr double kScore_min = 0.25;
constexpr double kCoverage_min = 0.45;
constexpr double kAgreement_min = 0.85;
constexpr double kGate_chi2 = 16.0;
constexpr double kUnmistakable_m = 1.0;  // three deviations within which no other place can be meant
constexpr double kTakenOut_weight = 0.2;
constexpr double kFilter_m = 1.0;  // deviation of the particle filter's pose
constexpr double kFilter_rad = 0.06;
constexpr int kIterations = 25;
constexpr int kIterations_again = 15;

}  // namespace

SubmapGraph::SubmapGraph(const GraphParams& params, const RobotLimits& limits, const ScanParams& scan,
                         std::uint64_t seed)
    : params_(params),
      scan_(scan),
      limits_(limits),
      rng_(seed, 2),
      store_(params.keyframes_max, params.keyframe_beams_max),
      builder_(params),
      graph_(params.submaps_max, params.constraints_max),
      matcher_(params, scan),
      plan_(params.submaps_max) {
  submaps_.reserve(static_cast<std::size_t>(params.submaps_max));
  corrections_.reserve(kCorrections_max);
}

bool SubmapGraph::add(const Keyframe& keyframe, std::span<const BeamCode> codes) {
  while (!is_localising() && is_full() && work()) {  // which may make room
  }
  if (!is_localising() && is_full()) {
    go_over(WorldUse::kLocalise);
  }
  if (is_localising()) {
    keep_path(keyframe);
  }
  if (builder_.is_to_end(keyframe.since_last)) {
    end_submap();
  }
  const int index = store_.size();
  if (has_room_for_submap()) {
    builder_.add(keyframe, codes, store_);
  }
  odom_slip_ = turned(matrix_of<2>(builder_.since_origin().map_slip), keyframe.odom_T_scan.yaw_rad);
  if (localiser_ && store_.size() > index) {
    if (const std::optional<PlaceBySubmap> place = std::exchange(expected_, {})) {
      localiser_->expect(graph_.component(place->submap), graph_.pose(place->submap) * place->submap_T_scan,
                         keyframe.odom_T_scan);
    }
    localiser_->add(store_, index);
    if (!is_localising() && !is_in_world() && !guess() && store_.size() - first_keyframe_ > anchor_keyframes_) {
      anchor_ = static_cast<int>(first_submap_);
      ++revision_;
    }
  }
  return has_work();
}

void SubmapGraph::localise() {
  const std::optional<Pose2> before = localiser_->guess();
  static_cast<void>(localiser_->work(world(), searched_, matcher_, rng_));
  revision_ += before.has_value() != localiser_->guess().has_value() ? 1 : 0;
  if (const std::optional<PieceMatch> match = localiser_->found()) {
    localiser_->forget();
    join(*match);
  }
}

std::optional<int> SubmapGraph::submap_of(int keyframe) const {
  for (std::size_t i = submaps_.size(); i > first_submap_; --i) {
    if (submaps_[i - 1].first_keyframe <= keyframe && keyframe < submaps_[i - 1].end_keyframe()) {
      return static_cast<int>(i - 1);
    }
  }
  return std::nullopt;
}

// Their keyframes belong to submaps only once these have ended.
void SubmapGraph::join(const PieceMatch& match) {
  end_submap();
  const std::optional<int> submap = submap_of(match.keyframe);
  if (!submap || !graph_.has_room(2)) {
    ++counts_.refused;
    return;
  }
  const Pose2 keyframe_T_submap = store_.submap_T_scan(match.keyframe).inverse();
  const Pose2 reference_T_submap = match.reference_T_keyframe * keyframe_T_submap;
  const Pose2 map_T_before = map_T_newest();
  const Pose2 old_T_new = graph_.pose(match.reference) * reference_T_submap * graph_.pose(*submap).inverse();
  graph_.move(graph_.component(is_in_world() ? match.reference : *submap),
              is_in_world() ? old_T_new.inverse() : old_T_new);
  graph_.add({.from = match.reference,
              .to = *submap,
              .from_T_to = reference_T_submap,
              .covariance = carried(match.covariance, keyframe_T_submap),
              .is_loop = true});
  ++counts_.accepted;
  note_closure(match.reference, *submap);
  is_to_solve_ = true;
  filter_.reset();  // it was of where the path was taken to lie
  anchor_ = match.reference;
  past_.join(old_T_new);
  localiser_.reset();
  note_correction(CorrectionCause::kFound, map_T_before);
  is_confirmed_ = match.is_expected;
  note_closures();
  revisited_ = graph_.size() - 3;
  begin_work(graph_.size() - 1);  // what was planned before knew nothing of the world
  ++revision_;
}

void SubmapGraph::end_submap() {
  while (work()) {
  }
  if (has_room_for_submap() && builder_.finish(store_)) {
    add_submap();
  }
}

// The filter weighs the hypotheses of a motion that is not credible: there its word counts. Elsewhere it tells where
// the robot is until a loop is closed, for it drifts less than a chain of motions; of its newest pose alone, for the
// errors of its poses are those of one map and would be counted again and again.
void SubmapGraph::add_submap() {
  const Submap& submap = builder_.finished();
  if (path_begin() == submaps_.size()) {
    graph_.add_node(map_T_local_ * store_[submap.first_keyframe].map_T_odom * submap.odom_T_submap);
  } else {
    const int last = graph_.size() - 1;
    const OdometryStretch& odometry = builder_.odometry();
    const Pose2 last_T_submap =
        odometry.is_torn() ? submaps_.back().local_T_submap.inverse() * submap.local_T_submap : odometry.start_T_end;
    const int node = graph_.add_node(graph_.pose(last) * last_T_submap);
    graph_.add({.from = last,
                .to = node,
                .from_T_to = last_T_submap,
                .covariance = odometry.constraint_covariance(limits_),
                .map_slip = matrix_of<2>(odometry.map_slip),
                .is_break = odometry.is_torn()});
    filter_ = {
        .node = node,
        .map_T_node = graph_.pose(static_cast<int>(path_begin())) * submaps_[path_begin()].local_T_submap.inverse() *
                      submap.local_T_submap,
        .covariance =
            Eigen::Vector3d(kFilter_m * kFilter_m, kFilter_m * kFilter_m, kFilter_rad * kFilter_rad).asDiagonal()};
    is_to_solve_ = true;
    matcher_.forget(last);
    matcher_.forget(last - 1);
  }
  submaps_.push_back(submap);
  plan_.add_submaps(1);
  ++revision_;
  begin_work(graph_.size() - 2);  // the newest one waits for the next, which completes its neighbourhood
}

void SubmapGraph::begin_work(int query) {
  constexpr double kAny_m = std::numeric_limits<double>::infinity();
  plan_.clear();
  newest_query_ = query;
  phase_ = Phase::kMatch;
  const auto first = static_cast<int>(first_submap_);
  if (query < 1 || (is_localising() && query < first)) {
    return;
  }
  plan_.append(graph_, query, first, params_.candidates, kAny_m);
  for (int i = 0; i < kRevisited; ++i) {
    revisited_ = revisited_ < first || revisited_ >= query - 1 ? first : revisited_;
    plan_.append(graph_, revisited_, first, kRevisited_candidates, kRevisited_sd_m);
    ++revisited_;
  }
}

bool SubmapGraph::work() {
  if (localiser_ && localiser_->has_work()) {
    localise();
    return has_work();
  }
  switch (phase_) {
    case Phase::kIdle:
      return false;
    case Phase::kMatch:
      try_next();
      break;
    case Phase::kVerify:
      verify();
      break;
    case Phase::kSolve:
      solve();
      break;
    case Phase::kThin:
      thin();
      break;
  }
  return has_work();
}

void SubmapGraph::try_next() {
  const std::optional<MatchPlan::Candidate> next = plan_.next(graph_);
  if (!next) {
    phase_ = has_held_back_ ? Phase::kVerify : is_to_solve_ ? Phase::kSolve : Phase::kIdle;
    return;
  }
  const MatchPlan::Candidate& candidate = *next;
  matcher_.set_query(world(), candidate.query);
  const Pose2 predicted = graph_.between(candidate.reference, candidate.query);
  SubmapSearch where{.centre = predicted, .half_m = kDeviations * candidate.sd_m + kSlack_m};
  if (where.half_m > kSearch_max_m) {  // near the reference, for that is where they overlap
    where.half_m = kSearch_max_m;
    where.centre.x_m = std::clamp(predicted.x_m, -kSlack_m, kSlack_m);
    where.centre.y_m = std::clamp(predicted.y_m, -kSlack_m, kSlack_m);
  }
  where.half_rad = std::clamp(kDeviations * candidate.sd_rad + kSlack_rad, 0.1,
                              candidate.sd_rad > kLostYaw_rad ? kLostSearch_rad : kSearch_max_rad);
  const SubmapMatch match = matcher_.match(world(), candidate.reference, where, rng_);
  ++counts_.tried;
  const Eigen::Vector3d error = error_between(match.reference_T_query, predicted);
  const Eigen::Matrix3d covariance = candidate.covariance + match.covariance;
  const bool is_credible = match.is_inside && match.agreement >= kAgreement_min && match.coverage >= kCoverage_min &&
                           match.score >= kScore_min && error.dot(covariance.inverse() * error) < kGate_chi2;
  if (!is_credible) {
    return;
  }
  ++counts_.credible;
  if (kDeviations * candidate.sd_m < kUnmistakable_m) {
    accept({candidate.reference, candidate.query, match}, false);
  } else {
    verifier_.add({candidate.reference, candidate.query, match});
    has_held_back_ = true;
  }
}

void SubmapGraph::accept(const LoopCandidate& candidate, bool is_new) {
  if (!graph_.has_room(2)) {  // one is left for the next submap's odometry
    ++counts_.refused;
    return;
  }
  graph_.add({.from = candidate.reference,
              .to = candidate.query,
              .from_T_to = candidate.match.reference_T_query,
              .covariance = candidate.match.covariance,
              .is_loop = true,
              .is_new = is_new});
  ++counts_.accepted;
  if (!is_new) {
    note_closure(candidate.reference, candidate.query);
  }
  is_to_solve_ = true;
}

void SubmapGraph::note_closure(int reference, int query) {
  ++next_correction_.loop_closures;
  next_correction_.reference = reference;
  next_correction_.query = query;
}

void SubmapGraph::verify() {
  for (const LoopCandidate& each : verifier_.verify(graph_, newest_query_)) {
    accept(each, true);
  }
  has_held_back_ = false;
  phase_ = is_to_solve_ ? Phase::kSolve : Phase::kIdle;
}

void SubmapGraph::solve() {
  const Pose2 map_T_before = map_T_newest();
  counts_.solve_chi2 = GraphSolver().solve(graph_, kIterations, filter_).chi2;
  bool again = false;
  for (Constraint& constraint : graph_.constraints()) {
    if (constraint.is_new && constraint.weight < kTakenOut_weight) {
      constraint.weight = 0.0;
      ++counts_.taken_out;
      again = true;
    } else if (constraint.is_new) {
      note_closure(constraint.from, constraint.to);
    }
    constraint.is_new = false;
  }
  if (again) {
    counts_.solve_chi2 = GraphSolver().solve(graph_, kIterations_again, filter_).chi2;
  }
  is_to_solve_ = false;
  note_correction(CorrectionCause::kLoop, map_T_before);
  note_closures();
  ++revision_;
  phase_ = Phase::kIdle;
  if (is_to_thin()) {
    phase_ = Phase::kThin;
    thinning_.emplace(world());
  }
}

Pose2 SubmapGraph::map_T_newest() const {
  return store_.size() > 0 ? map_T_odom() * store_[store_.size() - 1].odom_T_scan : Pose2{};
}

void SubmapGraph::note_correction(CorrectionCause cause, const Pose2& map_T_newest_before) {
  MapCorrection correction = std::exchange(next_correction_, {});
  if (correction.loop_closures == 0) {
    return;
  }
  const Pose2 now = map_T_newest();
  correction.stamp_ns = store_[store_.size() - 1].stamp_ns;
  correction.cause = cause;
  correction.moved = {now.x_m - map_T_newest_before.x_m, now.y_m - map_T_newest_before.y_m,
                      wrap_angle(now.yaw_rad - map_T_newest_before.yaw_rad)};
  if (corrections_.size() == kCorrections_max) {
    corrections_.erase(corrections_.begin());
  }
  corrections_.push_back(correction);
}

std::optional<MapCorrection> SubmapGraph::take_correction() {
  if (corrections_.empty()) {
    return std::nullopt;
  }
  const MapCorrection oldest = corrections_.front();
  corrections_.erase(corrections_.begin());
  return oldest;
}

void SubmapGraph::finish() {
  end_submap();
  while (work()) {
  }
  begin_work(own_submaps() > 0 ? graph_.size() - 1 : 0);
  while (work()) {
  }
  static_cast<void>(
      GraphSolver().solve(graph_, kIterations));  // of the map itself, which the filter's drift is not part of
  ++revision_;
}

// Where the path was lost: by the filter's map, which may have it yet.
Pose2 SubmapGraph::map_T_odom() const {
  if (path_begin() == submaps_.size()) {
    return store_.size() > first_keyframe_ ? map_T_local_ * store_[first_keyframe_].map_T_odom : lost_map_T_odom_;
  }
  const Submap& last = submaps_.back();
  return graph_.poses().back() * (is_behind_unknown_motion()
                                      ? last.local_T_submap.inverse() * store_[store_.size() - 1].map_T_odom
                                      : last.odom_T_submap.inverse());
}

TrajectoryCorrection SubmapGraph::correction() const {
  TrajectoryCorrection correction;
  std::vector<SubmapPlace> places;
  for (std::size_t i = run_begin_; i < submaps_.size(); ++i) {
    places.push_back({submaps_[i].odom_T_submap, graph_.pose(static_cast<int>(i)), submaps_[i].origin_stamp_ns});
  }
  const std::vector<SubmapPlace> past = past_.submaps(graph_);
  places.insert(places.end(), past.begin(), past.end());
  std::ranges::stable_sort(places, {}, &SubmapPlace::origin_stamp_ns);
  for (const SubmapPlace& each : places) {
    correction.add(each);
  }
  return correction;
}

std::vector<StampedPose> SubmapGraph::corrected(std::span<const StampedPose> odom) const {
  std::vector<StampedPose> poses(odom.begin(), odom.end());
  TrajectoryCorrection correction = this->correction();
  correction.survey(odom);
  correction.correct(poses);
  return poses;
}

}  // namespace odoless
