#include "core/graph/world_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr std::int8_t kWall = 8;
constexpr std::int8_t kBesideWall = 5;
constexpr std::int8_t kFree = -3;
constexpr double kClear_m = 0.4;  // before a return, where free space ends
constexpr double kSearchVoxel_m = 0.25;
constexpr double kApart_m = 1.0;
constexpr double kApart_rad = 0.2;

}  // namespace

WorldSearch::WorldSearch(const ScanParams& scan, int keyframe_beams_max)
    : frame_([&] {
        ScanParams of_keyframes = scan;
        of_keyframes.beams_max = std::max(keyframe_beams_max, 8);
        return of_keyframes;
      }()),
      raster_(std::size_t{kSide_cells} * kSide_cells),
      walls_(raster_.size()) {
  points_.reserve(kPoints_max);
}

void WorldSearch::begin(const KeyframeStore& store, std::span<const PathScan> piece) {
  count_ = 0;
  std::vector<Point2> all;
  std::unordered_set<std::int64_t> voxels;
  for (const PathScan& each : piece) {
    store.load(each.keyframe, 1, frame_);
    for (int beam = 0; beam < frame_.size(); ++beam) {
      if (!frame_.is_return(beam)) {
        continue;
      }
      const Point2 p = each.piece_T_scan * frame_.point(beam);
      constexpr std::int64_t kRow = 1 << 20;
      const auto voxel = static_cast<std::int64_t>(std::floor(p.x_m / kSearchVoxel_m)) * kRow +
                         static_cast<std::int64_t>(std::floor(p.y_m / kSearchVoxel_m));
      if (math::hypot(p.x_m, p.y_m) < kReach_m - kCell_m && voxels.insert(voxel).second) {
        all.push_back(p);
      }
    }
  }
  points_.clear();
  const std::size_t kept = std::min(all.size(), kPoints_max);
  for (std::size_t i = 0; i < kept; ++i) {
    points_.push_back(all[i * all.size() / kept]);
  }
}

std::int8_t* WorldSearch::cell(const Point2& p) {
  const int column = static_cast<int>(std::floor(p.x_m / kCell_m)) + kSide_cells / 2;
  const int row = static_cast<int>(std::floor(p.y_m / kCell_m)) + kSide_cells / 2;
  return column < 0 || row < 0 || column >= kSide_cells || row >= kSide_cells ? nullptr
                                                                              : &raster_[index_of(column, row)];
}

void WorldSearch::draw_scan(const Pose2& raster_T_scan) {
  const auto [s, c] = math::sincos(raster_T_scan.yaw_rad);
  for (int beam = 0; beam < frame_.size(); ++beam) {
    if (!frame_.is_return(beam)) {
      continue;
    }
    const Point2 d = frame_.direction(beam);
    const Point2 way{c * d.x_m - s * d.y_m, s * d.x_m + c * d.y_m};
    const double clear_m = frame_.range_m(beam) - kClear_m;
    constexpr double kStep_m = 0.8 * kCell_m;
    const int steps = std::max(0, static_cast<int>(std::ceil(clear_m / kStep_m)));
    for (int step = 0; step < steps; ++step) {
      const double at_m = step * kStep_m;
      std::int8_t* const free = cell({raster_T_scan.x_m + at_m * way.x_m, raster_T_scan.y_m + at_m * way.y_m});
      if (free == nullptr) {
        break;
      }
      *free = *free == 0 ? kFree : *free;
    }
    if (std::int8_t* const wall = cell(raster_T_scan * frame_.point(beam)); wall != nullptr) {
      *wall = kWall;
    }
  }
}

void WorldSearch::draw(const SubmapWorld& world, int submap) {
  std::fill(raster_.begin(), raster_.end(), std::int8_t{0});
  const auto draw_one = [&](int each) {
    const Submap& drawn = world.submaps[static_cast<std::size_t>(each)];
    const Pose2 submap_T_drawn = world.graph.between(submap, each);
    for (int k = drawn.first_keyframe; k < drawn.end_keyframe(); ++k) {
      world.store.load(k, 2, frame_);
      draw_scan(submap_T_drawn * world.store.submap_T_scan(k));
    }
  };
  draw_one(submap);
  for_each_neighbour(world.graph, submap, draw_one);
  blur();
}

void WorldSearch::blur() {
  walls_ = raster_;
  for (int row = 1; row + 1 < kSide_cells; ++row) {
    for (int column = 1; column + 1 < kSide_cells; ++column) {
      const std::size_t at = index_of(column, row);
      if (walls_[at] == kWall) {
        for (const int other :
             {-kSide_cells - 1, -kSide_cells, -kSide_cells + 1, -1, 1, kSide_cells - 1, kSide_cells, kSide_cells + 1}) {
          std::int8_t& beside = raster_[at + static_cast<std::size_t>(other)];
          beside = std::max(beside, kBesideWall);
        }
      }
    }
  }
}

void WorldSearch::correlate(double yaw_rad) {
  sums_.fill(0);
  const auto [s, c] = math::sincos(yaw_rad);
  constexpr int kFirst = (kSide_cells - kWindow_cells) / 2;
  for (const Point2& p : points_) {
    const int column = static_cast<int>(std::floor((c * p.x_m - s * p.y_m) / kCell_m)) + kFirst;
    const int row = static_cast<int>(std::floor((s * p.x_m + c * p.y_m) / kCell_m)) + kFirst;
    const std::int8_t* from = &raster_[index_of(column, row)];
    std::int16_t* to = sums_.data();
    for (int y = 0; y < kWindow_cells; ++y, from += kSide_cells, to += kWindow_cells) {
      for (int x = 0; x < kWindow_cells; ++x) {
        to[x] = static_cast<std::int16_t>(to[x] + from[x]);
      }
    }
  }
}

void WorldSearch::take_peaks(int submap, double yaw_rad) {
  const auto best = std::max_element(sums_.begin(), sums_.end());
  const auto at = static_cast<int>(best - sums_.begin());
  const int column = at % kWindow_cells - kWindow_cells / 2;
  const int row = at / kWindow_cells - kWindow_cells / 2;
  const double x_m = (column + 0.5) * kCell_m;
  const double y_m = (row + 0.5) * kCell_m;
  offer({submap, {x_m, y_m, yaw_rad}, *best / (static_cast<double>(kWall) * static_cast<double>(points_.size()))});
}

void WorldSearch::offer(const FoundPlace& place) {
  const auto end = found_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto same = std::find_if(found_.begin(), end, [&](const FoundPlace& each) {
    return each.submap == place.submap && each.submap_T_piece.distance_m(place.submap_T_piece) < kApart_m &&
           std::abs(wrap_angle(each.submap_T_piece.yaw_rad - place.submap_T_piece.yaw_rad)) < kApart_rad;
  });
  auto at = same;
  if (same == end) {
    if (count_ < kFound_max) {
      at = found_.begin() + static_cast<std::ptrdiff_t>(count_++);
      *at = place;
    } else {
      at = end - 1;
    }
  }
  if (place.score >= at->score) {
    *at = place;
    for (; at != found_.begin() && (at - 1)->score < at->score; --at) {
      std::iter_swap(at, at - 1);
    }
  }
}

void WorldSearch::look(const SubmapWorld& world, int submap) {
  if (points_.empty()) {
    return;
  }
  draw(world, submap);
  for (int i = 0; i < kDirections; ++i) {
    const double yaw_rad = wrap_angle(2.0 * std::numbers::pi * i / kDirections);
    correlate(yaw_rad);
    take_peaks(submap, yaw_rad);
  }
}

}  // namespace odoless
