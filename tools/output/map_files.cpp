#include "tools/output/map_files.hpp"

#include <fmt/core.h>

#include "core/base/check.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr int kOccupiedPercentMin = 65;
constexpr int kFreePercentMax = 25;
constexpr char kOccupiedGrey = 0;
constexpr char kFreeGrey = static_cast<char>(254);
constexpr char kUnknownGrey = static_cast<char>(205);

char grey_of(std::int8_t percent) {
  if (percent >= kOccupiedPercentMin) {
    return kOccupiedGrey;
  }
  return percent >= 0 && percent <= kFreePercentMax ? kFreeGrey : kUnknownGrey;
}

}  // namespace

std::string format_map_pgm(const OccupancyMap& map) {
  ODOLESS_CHECK(map.width_cells > 0 && map.height_cells > 0);
  std::string bytes = fmt::format("P5\n{} {}\n255\n", map.width_cells, map.height_cells);
  for (int row = map.height_cells - 1; row >= 0; --row) {
    for (int column = 0; column < map.width_cells; ++column) {
      bytes += grey_of(map.at(column, row));
    }
  }
  return bytes;
}

std::string format_map_yaml(const OccupancyMap& map, const std::string& image_name) {
  return fmt::format(
      "image: {}\nresolution: {:.6f}\norigin: [{:.6f}, {:.6f}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\nmode: trinary\n",
      image_name, map.resolution_m, map.origin_x_m, map.origin_y_m);
}

void write_map(const std::filesystem::path& folder, const OccupancyMap& map) {
  write_whole_file(folder / "map.pgm", format_map_pgm(map));
  write_whole_file(folder / "map.yaml", format_map_yaml(map, "map.pgm"));
}

}  // namespace odoless
