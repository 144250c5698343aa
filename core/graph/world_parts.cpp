#include "core/graph/world_parts.hpp"

#include <algorithm>
#include <cstddef>

namespace odoless {
namespace {

constexpr double kWay_min_m = 0.8;  // a piece of a path, with which places are told apart

}  // namespace

std::vector<bool> tell_places(const SubmapWorld& world, int submaps) {
  const auto count = static_cast<std::size_t>(submaps);
  const auto part = [&](std::size_t submap) {
    return static_cast<std::size_t>(world.graph.component(static_cast<int>(submap)));
  };
  std::vector<double> way_m(count, 0.0);  // of each part
  for (std::size_t i = 0; i < count; ++i) {
    const Submap& submap = world.submaps[i];
    for (int k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
      way_m[part(i)] += world.store[k].since_last.distance_m;
    }
  }
  const double longest_m = count == 0 ? 0.0 : *std::ranges::max_element(way_m);
  std::vector<bool> tells(count);
  for (std::size_t i = 0; i < count; ++i) {
    tells[i] = way_m[part(i)] >= std::min(kWay_min_m, longest_m);
  }
  return tells;
}

}  // namespace odoless
