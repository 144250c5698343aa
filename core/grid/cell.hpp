#pragma once

#include <algorithm>

namespace odoless {

/// What the beams said of one cell: the published opacity model of DP-SLAM [eliazar2004dpslam2].
struct Cell {
  float distance_m = 0.0F;  ///< way that beams travelled in it
  float hits = 0.0F;        ///< times that one stopped in it

  [[nodiscard]] bool is_unknown() const { return hits == 0.0F && distance_m == 0.0F; }
  /// Seen, and no beam ever stopped in it.
  [[nodiscard]] bool is_free() const { return hits == 0.0F && distance_m > 0.0F; }

  /// 1 / rho = hits / distance: the rate at which beams stop. The distance counts as at least `rho_min_m` per hit, lest
  /// a beam that stopped where it entered make a wall that nothing passes.
  [[nodiscard]] float stops_per_m(float rho_min_m) const { return hits / std::max(distance_m, hits * rho_min_m); }
};

}  // namespace odoless
