#pragma once

#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <occ_map/pixel_map_t.hpp>
#include <odoless_ros2/conversion.hpp>
#include <vector>

namespace odoless::ros {

/// The daemon's overview of its map. @return  False, and nothing is changed, for what is no such map: of other numbers,
/// of other sizes than it says, or of more than 100 million cells.
template <class OccupancyGrid>
[[nodiscard]] bool to_ros(const occ_map::pixel_map_t& map, const Frames& frames, OccupancyGrid& out) {
  constexpr std::int64_t kCells_max = 100'000'000;
  const std::int64_t cells = std::int64_t{map.dimensions[0]} * map.dimensions[1];
  if (map.dimensions[0] <= 0 || map.dimensions[1] <= 0 || cells > kCells_max || !(map.mpp > 0.0) ||
      !std::isfinite(map.xy0[0]) || !std::isfinite(map.xy0[1]) || map.data_type != occ_map::pixel_map_t::TYPE_UINT8) {
    return false;
  }
  std::vector<std::uint8_t> percent(static_cast<std::size_t>(cells));
  if (map.compressed != 0) {
    uLongf size_bytes = percent.size();
    if (::uncompress(percent.data(), &size_bytes, map.mapData.data(), map.mapData.size()) != Z_OK ||
        size_bytes != percent.size()) {
      return false;
    }
  } else if (map.mapData.size() == percent.size()) {
    percent.assign(map.mapData.begin(), map.mapData.end());
  } else {
    return false;
  }
  to_ros({.utime = map.utime,
          .lower_left_x_m = map.xy0[0],
          .lower_left_y_m = map.xy0[1],
          .cell_size_m = map.mpp,
          .columns = static_cast<std::uint32_t>(map.dimensions[0]),
          .rows = static_cast<std::uint32_t>(map.dimensions[1])},
         percent, frames, out);
  return true;
}

}  // namespace odoless::ros
