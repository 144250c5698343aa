#include "core/graph/map_piece.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

/// The part of a way, from 0 to its length, in which a coordinate that begins at `from` and changes by `slope` lies
/// within 0 and `side_cells`.
void clip(double from, double slope, double side_cells, double& begin, double& end) {
  if (slope == 0.0) {
    end = from < 0.0 || from > side_cells ? begin - 1.0 : end;
    return;
  }
  const double a = -from / slope;
  const double b = (side_cells - from) / slope;
  begin = std::max(begin, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

}  // namespace

void MapPiece::begin(const PieceIndex& index) {
  index_ = index;
  std::fill(cells_.begin(), cells_.end(), Cell{});
}

Cell& MapPiece::at(const GridCell& cell) {
  if (cell.tile<kBits>() == GridCell(0, 0).tile<kBits>()) {
    return cells_[cell.index_in_tile<kBits>()];
  }
  outside_ = Cell{};
  return outside_;
}

bool MapPiece::add(const KeyframeStore& store, const PlacedKeyframe& placed, const BeamModel& model, ScanFrame& frame) {
  const Pose2& pose = placed.map_T_scan;
  const Point2 start{pose.x_m / resolution_m_ - static_cast<double>(index_.column) * kSide_cells,
                     pose.y_m / resolution_m_ - static_cast<double>(index_.row) * kSide_cells};
  constexpr double kHalf_cells = 0.5 * kSide_cells;
  const double off_cells = std::max(std::abs(start.x_m - kHalf_cells), std::abs(start.y_m - kHalf_cells));
  if (off_cells > placed.farthest_m / resolution_m_ + kHalf_cells) {
    return false;
  }
  store.load(placed.keyframe, 1, frame);
  const auto [sin, cos] = math::sincos(pose.yaw_rad);
  for (int i = 0; i < frame.size(); ++i) {
    if (frame.is_return(i)) {
      const Point2 direction = frame.direction(i);
      add(model, start, {cos * direction.x_m - sin * direction.y_m, sin * direction.x_m + cos * direction.y_m},
          frame.range_m(i) / resolution_m_);
    }
  }
  return true;
}

void MapPiece::add(const BeamModel& model, const Point2& start, const Point2& direction, double length_cells) {
  double begin = 0.0;
  double end = length_cells;
  clip(start.x_m, direction.x_m, kSide_cells, begin, end);
  clip(start.y_m, direction.y_m, kSide_cells, begin, end);
  if (begin <= end) {
    const Point2 enters{start.x_m + begin * direction.x_m, start.y_m + begin * direction.y_m};
    model.integrate(*this, GridWalk(enters, direction, end - begin), end == length_cells);
  }
}

}  // namespace odoless
