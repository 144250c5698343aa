#include "core/graph/submap_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "core/geometry/pose2_covariance.hpp"
#include "core/match/peak_covariance.hpp"
#include "core/match/refine.hpp"
#include "core/math/elementary.hpp"
#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr int kQueryPoints_max = 800;
constexpr double kVoxel_m = 0.15;
constexpr int kRefine_steps = 12;
constexpr int kClimb_steps = 30;
constexpr double kProbe_step_m = 0.6;
constexpr double kProbe_min_m = 1.8;
constexpr double kProbe_max_m = 7.0;
constexpr double kProbe_peaks_m = 2.5;   // half the side of the box that other peaks count in, at least
constexpr double kRival_ratio = 0.75;    // score of a second peak that makes a match weak
constexpr double kRival_across_m = 0.3;  // of the unconstrained direction
constexpr double kWeak_sd_m = 0.3;       // along the unconstrained direction that makes a match weak
constexpr double kWeak_to_m = 5.0;       // deviation along it of a weak one
constexpr double kFloor_m = 0.03;        // what no covariance of a match undercuts
constexpr double kFloor_rad = 0.3 / 57.29578;
constexpr double kExplained = 0.2;  // value of the raster at a point

/// Effort by the size of the box, which a few metres and 35 deg fill with the odometry's.
SearchParams search_params(const SubmapSearch& where) {
  constexpr double kUsual_rad = 1.4835;
  const double volume = 0.25 * where.half_m * where.half_m * where.half_rad / kUsual_rad;
  const double effort = std::clamp(2.0 * std::sqrt(volume), 0.7, 4.0);
  SearchParams params;
  params.box_translation_m = where.half_m;
  params.box_rotation_rad = where.half_rad;
  params.start_points = static_cast<int>(params.start_points * effort);
  params.coarse_evaluations = static_cast<int>(params.coarse_evaluations * effort);
  params.spread_m = std::min(params.spread_m, 0.25 * where.half_m);
  return params;
}

int stride_for(int beams, int keyframes, int points_max) {
  return std::max(1, (beams * keyframes + points_max - 1) / points_max);
}

}  // namespace

SubmapMatcher::SubmapMatcher(const GraphParams& params, const ScanParams& scan)
    : params_(params),
      scan_(scan),
      ready_(static_cast<std::size_t>(params.references)),
      query_{PointSet(kQueryPoints_max), {}},
      search_({}, kQueryPoints_max) {
  scan_.beams_max = std::max(params.keyframe_beams_max, 8);
  for (Ready& each : ready_) {
    each.reference = std::make_unique<MatchReference>(params.reference, params.reference_points_max);
  }
  frames_.assign(std::size_t{3} * static_cast<std::size_t>(params.submap_keyframes), ScanFrame(scan_));
}

void SubmapMatcher::set_query(const SubmapWorld& world, int query) {
  if (query_submap_ == query) {
    return;
  }
  const Submap& submap = world.submaps[static_cast<std::size_t>(query)];
  piece_.clear();
  for (int k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
    piece_.push_back({k, world.store.submap_T_scan(k)});
  }
  set_query(world.store, piece_);
  query_submap_ = query;
}

void SubmapMatcher::set_query(const KeyframeStore& store, std::span<const PathScan> piece) {
  query_submap_ = -1;
  ScanFrame frame(scan_);
  PointSet points(scan_.beams_max);
  std::vector<Point2> kept;
  std::unordered_set<std::int64_t> voxels;
  query_.orientations.clear();
  for (const PathScan& each : piece) {
    store.load(each.keyframe, 1, frame);
    points.clear();
    append_thinned(frame, each.piece_T_scan, params_.reference.thinning_m, points);
    query_.orientations.add(frame, each.piece_T_scan.yaw_rad, params_.reference.thinning_m);
    for (int k = 0; k < points.size(); ++k) {
      const Point2 p = points[k];
      constexpr std::int64_t kRow = 1 << 20;
      const auto voxel = static_cast<std::int64_t>(std::floor(p.x_m / kVoxel_m)) * kRow +
                         static_cast<std::int64_t>(std::floor(p.y_m / kVoxel_m));
      if (math::hypot(p.x_m, p.y_m) <= params_.reference.fine.extent_m && voxels.insert(voxel).second) {
        kept.push_back(p);
      }
    }
  }
  query_.orientations.smooth();
  query_.points.clear();
  const double step = std::max(1.0, static_cast<double>(kept.size()) / kQueryPoints_max);
  double at = 0.0;
  while (at < static_cast<double>(kept.size()) && query_.points.size() < kQueryPoints_max) {
    query_.points.push_back(kept[static_cast<std::size_t>(at)]);
    at += step;
  }
}

void SubmapMatcher::forget_from(int first, int end) {
  for (Ready& each : ready_) {
    each.submap = first <= each.submap && each.submap < end ? -1 : each.submap;
  }
  query_submap_ = first <= query_submap_ && query_submap_ < end ? -1 : query_submap_;
}

void SubmapMatcher::place(const SubmapWorld& world, int reference, int submap) {
  const Submap& each = world.submaps[static_cast<std::size_t>(submap)];
  const Pose2 reference_T_submap = world.graph.between(reference, submap);
  const int beams = world.store[each.first_keyframe].beams;
  const int stride = stride_for(beams, 3 * params_.submap_keyframes, params_.reference_points_max);
  for (int i = 0; i < each.keyframes; ++i) {
    const int index = each.first_keyframe + i;
    ScanFrame& frame = frames_[placed_.size()];
    world.store.load(index, stride, frame);
    placed_.push_back({&frame, reference_T_submap * world.store.submap_T_scan(index)});
  }
}

MatchReference& SubmapMatcher::reference_of(const SubmapWorld& world, int submap) {
  Ready* oldest = &ready_.front();
  for (Ready& each : ready_) {
    if (each.submap == submap) {
      each.used = ++uses_;
      return *each.reference;
    }
    oldest = each.used < oldest->used ? &each : oldest;
  }
  placed_.clear();
  place(world, submap, submap);
  for_each_neighbour(world.graph, submap, [&](int neighbour) { place(world, submap, neighbour); });
  static_cast<void>(oldest->reference->rebuild(placed_));
  oldest->submap = submap;
  oldest->used = ++uses_;
  return *oldest->reference;
}

void SubmapMatcher::probe(const SearchGround& ground, const SubmapSearch& where, Point2 direction, Peaks& peaks) const {
  const SearchPoint best = peaks.best().point;
  const double counted_m = std::max(where.half_m, kProbe_peaks_m);
  const SearchBox counted{to_search_point(where.centre), {counted_m, counted_m, where.half_rad}};
  const double reach_m = std::max(kProbe_min_m, std::min(1.2 * where.half_m, kProbe_max_m));
  double way_m = 0.0;
  while ((way_m += kProbe_step_m) <= reach_m) {
    for (const double sign : {1.0, -1.0}) {
      SearchPoint start = best;
      start[0] += sign * way_m * direction.x_m;
      start[1] += sign * way_m * direction.y_m;
      int evaluations = 0;
      const ScoredPoint peak = PoseSearch::climb(ground, query_.points, start, kClimb_steps, evaluations);
      if (counted.holds(peak.point)) {
        peaks.offer(peak);
      }
    }
  }
}

void SubmapMatcher::judge(const ScoreRaster& raster, SubmapMatch& match) const {
  int explained = 0;
  int contradicted = 0;
  for (int i = 0; i < query_.points.size(); ++i) {
    const double value = raster.at(match.reference_T_query * query_.points[i]);
    explained += value > kExplained ? 1 : 0;
    contradicted += value < -kExplained ? 1 : 0;
  }
  const double known = std::max(1, explained + contradicted);
  match.agreement = explained / known;
  match.coverage = known / std::max(1, query_.points.size());
}

SubmapMatch SubmapMatcher::match(const SubmapWorld& world, int reference, const SubmapSearch& where, Rng& rng) {
  SubmapMatch out;
  MatchReference& in = reference_of(world, reference);
  if (in.empty() || query_.points.size() == 0) {
    return out;
  }
  const MotionPrior prior{where.centre, 0.0, 0.0, 0.0};
  const SearchGround ground{in.coarse(), in.fine(), in.orientations(), prior, in.exact_ndt()};
  search_.set_params(search_params(where));
  Peaks peaks = search_.run(ground, query_, rng).peaks;
  const auto top_of = [&] { return refine(in.exact_ndt(), query_.points, to_pose(peaks.best().point), kRefine_steps); };
  Refined top = top_of();
  Eigen::Matrix3d covariance = peak_covariance(top.derivatives, query_.points.size());
  const Eigen::Vector2d first_weak = math::principal_axes<2>(covariance.topLeftCorner<2, 2>()).axes.col(1);
  const SearchPoint before = peaks.best().point;
  probe(ground, where, {first_weak.x(), first_weak.y()}, peaks);
  if (peaks.best().point != before) {
    top = top_of();
    covariance = peak_covariance(top.derivatives, query_.points.size());
  }
  out.reference_T_query = top.reference_T_scan;
  out.score = peaks.best().score;
  out.is_inside = search_.box().holds(to_search_point(out.reference_T_query));
  judge(in.fine(), out);

  const math::PrincipalAxes<2> extent = math::principal_axes<2>(covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d weak = extent.axes.col(1);
  out.is_weak = extent.values(1) > kWeak_sd_m * kWeak_sd_m;
  if (peaks.size() > 1 && peaks.all()[1].score > kRival_ratio * peaks.best().score) {
    const SearchPoint& rival = peaks.all()[1].point;
    const Eigen::Vector2d way(rival[0] - peaks.best().point[0], rival[1] - peaks.best().point[1]);
    const double turn_rad = wrap_angle(rival[2] - peaks.best().point[2]);
    covariance(2, 2) += turn_rad * turn_rad;
    if (std::abs(way.dot(Eigen::Vector2d(-weak.y(), weak.x()))) > kRival_across_m) {
      covariance.topLeftCorner<2, 2>() += way * way.transpose();
    }
    out.is_weak = true;
  }
  if (out.is_weak) {
    covariance.topLeftCorner<2, 2>() += kWeak_to_m * kWeak_to_m * weak * weak.transpose();
  }
  covariance.diagonal() += Eigen::Vector3d(kFloor_m * kFloor_m, kFloor_m * kFloor_m, kFloor_rad * kFloor_rad);
  out.covariance = turned(covariance, -out.reference_T_query.yaw_rad);
  return out;
}

}  // namespace odoless
