#include "tools/output/map_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kMarginM = 1.0;
constexpr double kSideMinM = 8.0;       // room for the bar
constexpr int kSideMaxPx = 4096 - 128;  // beside what is drawn around it
static_assert(kPlanLeft_px + kPlanRight_px <= 128 && kPlanTop_px + kPlanBottom_px <= 128);
constexpr int kSideWantedPx = 800;
constexpr int kUnknownGrey = 205;
constexpr Rgb kSubmapsColour{220, 50, 32};
constexpr Rgb kClosureColour{46, 125, 50};

/// The part of the map to show, in cells of the map; it may reach beyond the map.
struct Crop {
  int column_begin = std::numeric_limits<int>::max();
  int row_begin = std::numeric_limits<int>::max();
  int column_end = std::numeric_limits<int>::min();
  int row_end = std::numeric_limits<int>::min();

  void add(int column, int row) {
    column_begin = std::min(column_begin, column);
    row_begin = std::min(row_begin, row);
    column_end = std::max(column_end, column + 1);
    row_end = std::max(row_end, row + 1);
  }
  [[nodiscard]] int width() const { return column_end - column_begin; }
  [[nodiscard]] int height() const { return row_end - row_begin; }
};

void widen(int& begin, int& end, int margin, int least) {
  const int missing = std::max(2 * margin, least - (end - begin));
  begin -= missing / 2;
  end += missing - missing / 2;
}

Crop find_crop(const OccupancyMap& map) {
  Crop crop;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      if (map.at(column, row) != OccupancyMap::kUnknown) {
        crop.add(column, row);
      }
    }
  }
  if (crop.column_end < crop.column_begin) {
    crop = {0, 0, map.width_cells, map.height_cells};
  }
  const int margin = static_cast<int>(std::ceil(kMarginM / map.resolution_m));
  const int least = static_cast<int>(std::ceil(kSideMinM / map.resolution_m));
  widen(crop.column_begin, crop.column_end, margin, least);
  widen(crop.row_begin, crop.row_end, margin, least);
  return crop;
}

/// How map coordinates become pixels: a small map is magnified, a large one shrunk, by whole numbers.
class View {
 public:
  explicit View(const OccupancyMap& map) : map_(map), crop_(find_crop(map)) {
    const int side = std::max(crop_.width(), crop_.height());
    cells_per_px_ = (side + kSideMaxPx - 1) / kSideMaxPx;
    px_per_cell_ = std::max(1, kSideWantedPx / side);
  }

  [[nodiscard]] int width_px() const { return to_px(crop_.width()); }
  [[nodiscard]] int height_px() const { return to_px(crop_.height()); }
  [[nodiscard]] double px_per_m() const { return px_per_cell_ / (map_.resolution_m * cells_per_px_); }

  /// The likeliest occupied of the cells that a pixel shows.
  [[nodiscard]] std::int8_t percent(Pixel pixel) const {
    const int column_begin = crop_.column_begin + pixel.column_px * cells_per_px_ / px_per_cell_;
    const int row_begin = crop_.row_begin + (height_px() - 1 - pixel.row_px) * cells_per_px_ / px_per_cell_;
    std::int8_t highest = OccupancyMap::kUnknown;
    for (int row = row_begin; row < row_begin + cells_per_px_; ++row) {
      for (int column = column_begin; column < column_begin + cells_per_px_; ++column) {
        if (column >= 0 && column < map_.width_cells && row >= 0 && row < map_.height_cells) {
          highest = std::max(highest, map_.at(column, row));
        }
      }
    }
    return highest;
  }

  [[nodiscard]] Point2 low() const {
    return {map_.origin_x_m + crop_.column_begin * map_.resolution_m,
            map_.origin_y_m + crop_.row_begin * map_.resolution_m};
  }

 private:
  [[nodiscard]] int to_px(int cells) const { return (cells * px_per_cell_ + cells_per_px_ - 1) / cells_per_px_; }

  const OccupancyMap& map_;
  Crop crop_;
  int cells_per_px_ = 1;
  int px_per_cell_ = 1;
};

void draw_cells(const View& view, Canvas& canvas) {
  for (int row = 0; row < view.height_px(); ++row) {
    for (int column = 0; column < view.width_px(); ++column) {
      const std::int8_t percent = view.percent({column, row});
      const auto grey = static_cast<std::uint8_t>(percent < 0 ? kUnknownGrey : 255 - percent * 255 / 100);
      canvas.set({column, row}, {grey, grey, grey});
    }
  }
}

}  // namespace

Drawing draw_map(const OccupancyMap& map, std::span<const ColouredPath> paths, const std::string& title) {
  ODOLESS_CHECK(map.width_cells > 0 && map.height_cells > 0 && map.resolution_m > 0.0);
  const View view(map);
  Canvas canvas(view.width_px(), view.height_px(), {});
  draw_cells(view, canvas);
  return draw_plan({.title = title,
                    .picture = std::move(canvas),
                    .low = view.low(),
                    .px_per_m = view.px_per_m(),
                    .paths = {paths.begin(), paths.end()}});
}

void write_map_picture(const std::filesystem::path& path, const OccupancyMap& map, std::span<const ColouredPath> paths,
                       const std::string& title) {
  write_drawing(path, draw_map(map, paths, title));
}

void write_graph_picture(const std::filesystem::path& path, const OccupancyMap& map, const PoseGraph& graph,
                         const std::string& title) {
  std::vector<ColouredPath> paths;
  for (const Constraint& constraint : graph.constraints()) {
    if (constraint.is_loop && constraint.weight > 0.0) {
      paths.push_back({{graph.pose(constraint.from), graph.pose(constraint.to)},
                       kClosureColour,
                       paths.empty() ? "loop closures" : ""});
    }
  }
  paths.push_back({{graph.poses().begin(), graph.poses().end()}, kSubmapsColour, "submaps"});
  write_map_picture(path, map, paths, title);
}

}  // namespace odoless
