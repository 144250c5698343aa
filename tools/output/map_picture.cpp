#include "tools/output/map_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"
#include "tools/output/scale_bar.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr double kMarginM = 1.0;
constexpr double kSideMinM = 8.0;  // room for the bar
constexpr int kSideMaxPx = 4096;
constexpr int kSideWantedPx = 800;
constexpr int kFooterPx = kScaleBarHeightPx;
constexpr int kStartRadiusPx = 6;
constexpr int kUnknownGrey = 205;
constexpr Rgb kWhite{255, 255, 255};

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
    cells_per_px_ = (side + kSideMaxPx - kFooterPx - 1) / (kSideMaxPx - kFooterPx);
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

  /// Where a point is shown; false when that is off the picture.
  [[nodiscard]] bool find(const Pose2& point, Pixel& pixel) const {
    const double left_m = map_.origin_x_m + crop_.column_begin * map_.resolution_m;
    const double bottom_m = map_.origin_y_m + crop_.row_begin * map_.resolution_m;
    const double column_px = (point.x_m - left_m) * px_per_m();
    const double up_px = (point.y_m - bottom_m) * px_per_m();
    if (!(column_px >= 0.0 && column_px < width_px() && up_px >= 0.0 && up_px < height_px())) {
      return false;
    }
    pixel = {static_cast<int>(column_px), height_px() - 1 - static_cast<int>(up_px)};
    return true;
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

void draw_path(const View& view, const ColouredPath& path, Canvas& canvas) {
  Pixel before;
  bool is_drawing = false;
  for (const Pose2& pose : path.poses) {
    Pixel here;
    const bool is_visible = view.find(pose, here);
    if (is_visible) {
      canvas.line(is_drawing ? before : here, here, path.rgb);
      before = here;
    }
    is_drawing = is_visible;
  }
  if (Pixel start; !path.poses.empty() && view.find(path.poses.front(), start)) {
    canvas.disc(start, kStartRadiusPx, kWhite);
    canvas.disc(start, kStartRadiusPx - 2, path.rgb);
  }
}

}  // namespace

Canvas draw_map(const OccupancyMap& map, std::span<const ColouredPath> paths) {
  ODOLESS_CHECK(map.width_cells > 0 && map.height_cells > 0 && map.resolution_m > 0.0);
  const View view(map);
  Canvas canvas(view.width_px(), view.height_px() + kFooterPx, kWhite);
  draw_cells(view, canvas);
  for (const ColouredPath& path : paths) {
    draw_path(view, path, canvas);
  }
  draw_scale_bar(view.px_per_m(), canvas);
  return canvas;
}

void write_map_picture(const std::filesystem::path& path, const OccupancyMap& map,
                       std::span<const ColouredPath> paths) {
  write_whole_file(path, draw_map(map, paths).png());
}

}  // namespace odoless
