#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/grid/grid_geometry.hpp"
#include "core/math/elementary.hpp"
#include "core/scan/scan_frame.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// A beam in the scan frame.
struct Beam {
  Point2 direction;
  double range_m = 0.0;
  bool stopped = true;  ///< false: it passed range_m
};

/// A pose with its rotation ready, to cast many beams from it into a grid.
class BeamCaster {
 public:
  BeamCaster(const GridGeometry& grid, const Pose2& map_T_scan)
      : start_cells_(grid.cells(map_T_scan.x_m, map_T_scan.y_m)),
        cells_per_m_(1.0 / grid.resolution_m),
        cos_(math::cos(map_T_scan.yaw_rad)),
        sin_(math::sin(map_T_scan.yaw_rad)) {}

  /// The walk along a direction of the scan frame, `length_m` far.
  [[nodiscard]] GridWalk walk(const Point2& direction, double length_m) const {
    return {start_cells_,
            {cos_ * direction.x_m - sin_ * direction.y_m, sin_ * direction.x_m + cos_ * direction.y_m},
            length_m * cells_per_m_};
  }

 private:
  Point2 start_cells_;
  double cells_per_m_;
  double cos_;
  double sin_;
};

/// Picks every k-th usable beam of a scan, with the least k that leaves at most `beams_max`.
///
/// Real time: does not allocate if `beams` has room for `beams_max`.
inline void select_beams(const ScanFrame& scan, int beams_max, bool with_no_returns, std::vector<Beam>& beams) {
  const auto usable = [&](int beam) {
    return scan.is_return(beam) || (with_no_returns && scan.state(beam) == BeamState::kNoReturn);
  };
  int count = 0;
  for (int i = 0; i < scan.size(); ++i) {
    count += usable(i) ? 1 : 0;
  }
  const int step = std::max(1, (count + beams_max - 1) / beams_max);
  beams.clear();
  int index = 0;
  for (int i = 0; i < scan.size(); ++i) {
    if (usable(i) && index++ % step == 0) {
      const bool stopped = scan.is_return(i);
      beams.push_back({scan.direction(i), stopped ? scan.range_m(i) : scan.range_max_m(), stopped});
    }
  }
}

/// Likelihood of one beam from the caster's pose in one map.
template <class Map>
[[nodiscard]] float likelihood(const BeamModel& model, const BeamCaster& caster, Map& map, const Beam& beam,
                               double cells_per_m) {
  const auto range_cells = static_cast<float>(beam.range_m * cells_per_m);
  const double reach_m = beam.stopped ? model.reach_cells() / cells_per_m : 0.0;
  const GridWalk walk = caster.walk(beam.direction, beam.range_m + reach_m);
  return beam.stopped ? model.likelihood(map, walk, range_cells) : model.likelihood_of_passing(map, walk);
}

/// Log-likelihood of the beams, taken for independent, from one pose in one map.
template <class Map>
[[nodiscard]] double log_likelihood(const BeamModel& model, const BeamCaster& caster, Map& map,
                                    std::span<const Beam> beams, double cells_per_m) {
  double sum = 0.0;
  for (const Beam& beam : beams) {
    sum += math::log(likelihood(model, caster, map, beam, cells_per_m));
  }
  return sum;
}

/// Every `step`-th beam of a scan from `first` on, before `end`.
struct ScanPart {
  ScanPart(const ScanFrame& whole) : scan(whole), end(whole.size()) {}  // NOLINT(google-explicit-constructor)
  ScanPart(const ScanFrame& of, int from, int to, int every) : scan(of), first(from), end(to), step(every) {}

  const ScanFrame& scan;
  int first = 0;
  int end;
  int step = 1;
};

/// Adds every return of the part to a map, and, where `free_no_return_m` is not 0, the free way of beams without one.
template <class Map>
void integrate_scan(const BeamModel& model, const BeamCaster& caster, Map& map, const ScanPart& part,
                    double free_no_return_m) {
  const ScanFrame& scan = part.scan;
  for (int i = part.first; i < part.end; i += part.step) {
    if (scan.is_return(i)) {
      model.integrate(map, caster.walk(scan.direction(i), scan.range_m(i)), true);
    } else if (free_no_return_m > 0.0 && scan.state(i) == BeamState::kNoReturn) {
      model.integrate(map, caster.walk(scan.direction(i), free_no_return_m), false);
    }
  }
}

}  // namespace odoless
