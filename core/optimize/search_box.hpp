#pragma once

#include <array>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// A pose sought: (x_m, y_m, yaw_rad).
using SearchPoint = std::array<double, 3>;

/// Axis-aligned box of poses.
struct SearchBox {
  SearchPoint centre{};
  SearchPoint half_size{2.0, 2.0, 1.5};

  /// Brings every coordinate back into the box by reflection at its walls.
  void reflect(SearchPoint& point) const;
  /// Whether the point is in the box or on its walls.
  [[nodiscard]] bool holds(const SearchPoint& point) const;
  /// The point at fractions (u, v, w) in [0, 1] of the box.
  [[nodiscard]] SearchPoint at(const SearchPoint& fractions) const;
};

/// Element `index` (from 0) of the Halton sequence with bases 2, 3 and 5: even cover of the unit cube [halton1960;
/// method 3].
[[nodiscard]] SearchPoint halton(int index);

[[nodiscard]] inline Pose2 to_pose(const SearchPoint& p) { return {p[0], p[1], p[2]}; }
[[nodiscard]] inline SearchPoint to_search_point(const Pose2& p) { return {p.x_m, p.y_m, p.yaw_rad}; }

}  // namespace odoless
