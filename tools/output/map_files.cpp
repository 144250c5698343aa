#include "tools/output/map_files.hpp"

#include <fmt/core.h>

#include <cstdio>

#include "core/base/check.hpp"
#include "tools/command/error.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr int kOccupiedPercentMin = 65;
constexpr int kFreePercentMax = 25;
constexpr char kOccupiedByte = 0;
constexpr char kFreeByte = static_cast<char>(254);
constexpr char kUnknownByte = static_cast<char>(205);

char grey_of(std::int8_t percent) {
  if (percent >= kOccupiedPercentMin) {
    return kOccupiedByte;
  }
  return percent >= 0 && percent <= kFreePercentMax ? kFreeByte : kUnknownByte;
}

std::int8_t percent_of(char grey) {
  if (grey == kOccupiedByte) {
    return 100;
  }
  return grey == kFreeByte ? std::int8_t{0} : OccupancyMap::kUnknown;
}

/// Fills the cells from the picture's bytes; false where these are no picture of ours.
bool parse_pgm(const std::string& bytes, OccupancyMap& map) {
  int header_bytes = 0;
  // NOLINTNEXTLINE(cert-err34-c): what does not convert leaves header_bytes at 0
  std::sscanf(bytes.c_str(), "P5 %d %d 255%n", &map.width_cells, &map.height_cells, &header_bytes);
  const std::size_t first = static_cast<std::size_t>(header_bytes) + 1;
  const auto width = static_cast<std::size_t>(map.width_cells);
  const auto height = static_cast<std::size_t>(map.height_cells);
  if (header_bytes == 0 || map.width_cells < 1 || map.height_cells < 1 || bytes.size() != first + width * height) {
    return false;
  }
  map.occupancy_percent.resize(width * height);
  for (std::size_t i = 0; i < width * height; ++i) {
    map.occupancy_percent[i] = percent_of(bytes[first + (height - 1 - i / width) * width + i % width]);
  }
  return true;
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

OccupancyMap read_map(const std::filesystem::path& folder) {
  OccupancyMap map;
  const std::string yaml = read_whole_file(folder / "map.yaml");
  // NOLINTNEXTLINE(cert-err34-c): the count says what was converted
  const int fields = std::sscanf(yaml.c_str(), "image: map.pgm resolution: %lf origin: [%lf, %lf", &map.resolution_m,
                                 &map.origin_x_m, &map.origin_y_m);
  if (fields != 3) {
    throw DataError((folder / "map.yaml").string(), 0, "no resolution and origin", "what `odoless replay` writes");
  }
  if (!parse_pgm(read_whole_file(folder / "map.pgm"), map)) {
    throw DataError((folder / "map.pgm").string(), 0, "no map", "what `odoless replay` writes");
  }
  return map;
}

}  // namespace odoless
