#include "core/match/pose_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kApart_m = 0.4;
constexpr double kApart_rad = 0.2;
constexpr SearchPoint kSimplexSize{0.05, 0.05, 0.02};
constexpr int kOther_peaks = 2;  // sought besides the best one and that of the expected pose

// Of Cauchy's law cut to +-half, whose tails reach all of the box: half of the offsets are within a deviation.
double cauchy_offset(double fraction, double sd, double half) {
  return sd * math::tan((2.0 * fraction - 1.0) * math::atan(half / sd));
}

SearchPoint expected_at(const MotionPrior& prior, const SearchBox& box, const SearchPoint& fractions) {
  return {box.centre[0] + cauchy_offset(fractions[0], prior.sd_m, box.half_size[0]),
          box.centre[1] + cauchy_offset(fractions[1], prior.sd_m, box.half_size[1]),
          box.centre[2] + cauchy_offset(fractions[2], prior.sd_rad, box.half_size[2])};
}

}  // namespace

bool clearly_apart(const SearchPoint& a, const SearchPoint& b) {
  return math::hypot(a[0] - b[0], a[1] - b[1]) > kApart_m || std::abs(wrap_angle(a[2] - b[2])) > kApart_rad;
}

bool Peaks::is_apart(const SearchPoint& pose) const {
  return std::all_of(peaks_.begin(), peaks_.begin() + static_cast<std::ptrdiff_t>(size_),
                     [&](const ScoredPoint& peak) { return clearly_apart(peak.point, pose); });
}

void Peaks::offer(const ScoredPoint& pose) {
  std::size_t place = size_ < kMost ? size_ : kMost - 1;
  for (std::size_t i = 0; i < size_; ++i) {
    if (!clearly_apart(peaks_[i].point, pose.point)) {
      place = i;
      break;
    }
  }
  if (place < size_ && peaks_[place].score >= pose.score) {
    return;
  }
  peaks_[place] = pose;
  size_ = std::max(size_, place + 1);
  for (; place > 0 && peaks_[place].score > peaks_[place - 1].score; --place) {
    std::swap(peaks_[place], peaks_[place - 1]);
  }
}

double MotionPrior::penalty(const SearchPoint& pose) const {
  if (!is_known()) {
    return 0.0;
  }
  const double x = (pose[0] - reference_T_scan.x_m) / sd_m;
  const double y = (pose[1] - reference_T_scan.y_m) / sd_m;
  const double relative_yaw = wrap_angle(pose[2] - reference_T_scan.yaw_rad) / sd_rad;
  const double squares = x * x + y * y + relative_yaw * relative_yaw;
  return squares > 1.0 ? weight * math::log(squares) : 0.0;
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
  return nelder_mead({start, fine(start)}, kSimplexSize, steps, fine, ground.deadline);
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
    const double expected = params_.expected_share * i;
    const bool is_as_expected =
        ground.prior.is_known() && std::floor(expected + params_.expected_share) > std::floor(expected);
    SearchPoint pose = is_as_expected ? expected_at(ground.prior, box, fractions) : box.at(fractions);
    if (!is_as_expected) {
      pose[2] = centre[2] + angles_.offset_rad(fractions[2]);
    }
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

void PoseSearch::add_other_peaks(const Objective& fine, const Deadline& deadline, Peaks& peaks) {
  for (int other = 0; other < kOther_peaks; ++other) {
    const DeMember* start = nullptr;
    for (const DeMember& member : evolution_.population()) {
      if ((start == nullptr || member.score > start->score) && peaks.is_apart(member.point)) {
        start = &member;
      }
    }
    if (start == nullptr) {
      return;
    }
    peaks.offer(nelder_mead({start->point, start->score}, kSimplexSize, params_.simplex_steps / 2, fine, deadline));
  }
}

SearchOutcome PoseSearch::run(const SearchGround& ground, const SearchedScan& scan, Rng& rng) {
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
    outcome.stop = evolution_.evolve(coarse, params_.coarse_evaluations, ground.deadline, rng);
    cross_over_to(fine, rng);
  } else {
    start(fine, ground, scan);
  }
  if (outcome.stop == StopReason::kBudget) {
    outcome.stop = evolution_.evolve(fine, params_.fine_evaluations, ground.deadline, rng);
  }
  const DeMember& best = evolution_.best();
  outcome.peaks.offer(nelder_mead({best.point, best.score}, kSimplexSize, params_.simplex_steps, fine));
  const SearchPoint centre = to_search_point(ground.prior.reference_T_scan);
  outcome.peaks.offer(nelder_mead({centre, fine(centre)}, kSimplexSize, params_.simplex_steps, fine, ground.deadline));
  add_other_peaks(fine, ground.deadline, outcome.peaks);
  return outcome;
}

}  // namespace odoless
