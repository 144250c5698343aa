#include "core/match/pose_search.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kApart_m = 0.4;
constexpr double kApart_rad = 0.2;
constexpr SearchPoint kSimplexSize{0.05, 0.05, 0.02};

}  // namespace

bool clearly_apart(const SearchPoint& a, const SearchPoint& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]) > kApart_m || std::abs(wrap_angle(a[2] - b[2])) > kApart_rad;
}

double MotionPrior::penalty(const SearchPoint& pose) const {
  if (sd_m <= 0.0 || sd_rad <= 0.0) {
    return 0.0;
  }
  const double x = (pose[0] - reference_T_scan.x_m) / sd_m;
  const double y = (pose[1] - reference_T_scan.y_m) / sd_m;
  const double relative_yaw = wrap_angle(pose[2] - reference_T_scan.yaw_rad) / sd_rad;
  const double squares = x * x + y * y + relative_yaw * relative_yaw;
  return squares > 1.0 ? weight * std::log(squares) : 0.0;
}

// Mean score per point of a pose in the reference's axes, so that translation and rotation are independent.
struct PoseSearch::Objective {
  const ScoreRaster& raster;
  const PointSet& points;
  const MotionPrior& prior;
  int& evaluations;
  const Ndt* exact_ndt = nullptr;  // in place of the raster

  double operator()(const SearchPoint& pose) const {
    ++evaluations;
    const double sum = exact_ndt != nullptr ? exact_ndt->score(points, to_pose(pose))
                                            : raster.score(points.x_m(), points.y_m(), to_pose(pose));
    return sum / points.size() - prior.penalty(pose);
  }
};

PoseSearch::PoseSearch(const SearchParams& params, int points_max)
    : params_(params), subset_(points_max), evolution_(params.de) {
  ODOLESS_CHECK(parameters_in_range(params));
}

ScoredPoint PoseSearch::climb(const SearchGround& ground, const PointSet& points, const SearchPoint& start, int steps,
                              int& evaluations) {
  const Objective fine{ground.fine, points, ground.prior, evaluations};
  return nelder_mead({start, fine(start)}, kSimplexSize, steps, fine);
}

void PoseSearch::start(const Objective& objective, const SearchGround& ground, const SearchedScan& scan) {
  const SearchPoint centre = to_search_point(ground.prior.reference_T_scan);
  angles_.rebuild(ground.reference_orientations, scan.orientations, centre[2], params_.box_rotation_rad,
                  params_.angle_floor);
  const SearchBox box{centre, {params_.box_translation_m, params_.box_translation_m, params_.box_rotation_rad}};
  evolution_.begin(box);
  evolution_.offer(centre, objective(centre));
  for (int i = 1; i < params_.start_points; ++i) {
    const SearchPoint fractions = halton(i);
    SearchPoint pose = box.at(fractions);
    pose[2] = centre[2] + angles_.offset_rad(fractions[2]);
    box.reflect(pose);
    evolution_.offer(pose, objective(pose));
  }
}

void PoseSearch::cross_over_to(const Objective& fine, Rng& rng) {
  const std::span<DeMember> members = evolution_.population();
  std::sort(members.begin(), members.end(), [](const DeMember& a, const DeMember& b) { return a.score > b.score; });
  for (std::size_t i = 0; i < members.size() / 2; ++i) {
    DeMember& worse = members[members.size() - 1 - i];
    worse.point = members[i].point;
    worse.point[0] += params_.spread_m * rng.normal();
    worse.point[1] += params_.spread_m * rng.normal();
    evolution_.box().reflect(worse.point);
  }
  for (DeMember& member : members) {
    member.score = fine(member.point);
  }
  for (std::size_t i = members.size() - 1; i > 0; --i) {  // neighbours in the ring must not be neighbours in rank
    std::swap(members[i], members[rng.below(static_cast<std::uint32_t>(i + 1))]);
  }
  evolution_.find_best();
}

std::optional<ScoredPoint> PoseSearch::second_peak(const Objective& fine, const ScoredPoint& best) {
  const DeMember* other = nullptr;
  for (const DeMember& member : evolution_.population()) {
    if ((other == nullptr || member.score > other->score) && clearly_apart(member.point, best.point)) {
      other = &member;
    }
  }
  if (other == nullptr) {
    return std::nullopt;
  }
  const ScoredPoint top = nelder_mead({other->point, other->score}, kSimplexSize, params_.simplex_steps / 2, fine);
  return clearly_apart(top.point, best.point) ? std::optional(top) : std::nullopt;
}

SearchOutcome PoseSearch::run(const SearchGround& ground, const SearchedScan& scan, const Deadline& deadline,
                              Rng& rng) {
  SearchOutcome outcome;
  subset_.clear();
  for (int i = 0; i < scan.points.size(); i += params_.coarse_every) {
    subset_.push_back(scan.points[i]);
  }
  const Objective coarse{ground.coarse, subset_, ground.prior, outcome.evaluations};
  const Objective fine{ground.fine, scan.points, ground.prior, outcome.evaluations,
                       params_.exact ? &ground.exact_ndt : nullptr};
  if (params_.coarse_evaluations > 0) {
    start(coarse, ground, scan);
    outcome.stop = evolution_.evolve(coarse, params_.coarse_evaluations, deadline, rng);
    cross_over_to(fine, rng);
  } else {
    start(fine, ground, scan);
  }
  if (outcome.stop == StopReason::kBudget) {
    outcome.stop = evolution_.evolve(fine, params_.fine_evaluations, deadline, rng);
  }
  outcome.best =
      nelder_mead({evolution_.best().point, evolution_.best().score}, kSimplexSize, params_.simplex_steps, fine);
  const SearchPoint centre = to_search_point(ground.prior.reference_T_scan);
  const ScoredPoint near = nelder_mead({centre, fine(centre)}, kSimplexSize, params_.simplex_steps, fine);
  if (near.score > outcome.best.score) {
    outcome.best = near;
  }
  outcome.second = second_peak(fine, outcome.best);
  if (outcome.second && outcome.second->score > outcome.best.score) {
    std::swap(*outcome.second, outcome.best);
  }
  return outcome;
}

}  // namespace odoless
