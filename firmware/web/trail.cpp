#include "firmware/web/trail.hpp"

#include <algorithm>

#include "core/math/elementary.hpp"

namespace odoless {

void Trail::add(const Point2& p_map) {
  if (!points_.empty() && math::hypot(p_map.x_m - points_.back().x_m, p_map.y_m - points_.back().y_m) < spacing_m_) {
    return;
  }
  if (points_.size() == kPoints) {
    for (std::size_t i = 0; i < kPoints / 2; ++i) {
      points_[i] = points_[2 * i];
    }
    points_.resize(kPoints / 2);
    spacing_m_ *= 2.0;
    ++edition_;
  }
  points_.push_back(p_map);
}

void Trail::clear() {
  points_.clear();
  spacing_m_ = kSpacing_m;
  ++edition_;
}

std::span<const Point2> Trail::next(TrailCursor& cursor, std::size_t most) const {
  if (cursor.edition != edition_) {
    cursor = {.edition = edition_, .points = 0};
  }
  const auto rest = std::span(points_).subspan(cursor.points);
  const std::span<const Point2> given = rest.first(std::min(most, rest.size()));
  cursor.points += given.size();
  return given;
}

}  // namespace odoless
