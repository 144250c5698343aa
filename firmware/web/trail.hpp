#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// How much of a trail somebody has.
struct TrailCursor {
  std::uint32_t edition = 0;  ///< 0: nothing
  std::size_t points = 0;
};

/// The way that was gone, in at most `kPoints` points: when it is full, every second point goes, and from then on they
/// lie twice as far apart.
///
/// Memory: at construction.
class Trail {
 public:
  static constexpr std::size_t kPoints = 4096;

  Trail() { points_.reserve(kPoints); }

  void add(const Point2& p_map);
  void clear();

  /// At most `most` points that the owner of the cursor lacks; `cursor` is moved behind them. A cursor of another
  /// edition begins with the first point.
  [[nodiscard]] std::span<const Point2> next(TrailCursor& cursor, std::size_t most) const;

 private:
  static constexpr double kSpacing_m = 0.1;

  std::vector<Point2> points_;
  double spacing_m_ = kSpacing_m;
  std::uint32_t edition_ = 1;  ///< grows when points that were told are no longer there
};

}  // namespace odoless
