#include "tools/experiment/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace odoless {
namespace {

constexpr int kPanelWidthPx = 760;
constexpr int kPanelHeightPx = 260;
constexpr int kSquareWidthPx = 620;
constexpr int kSquareHeightPx = 560;
constexpr int kUnknownGrey = 205;
constexpr int kMapPixelsMax = 700;  // a side: more is not seen, and takes room in the report

bool is_alike(const Chart& panel) { return panel.alike || panel.map.has_value() || panel.picture.has_value(); }

bool has_axes(const Chart& panel) { return !panel.picture || panel.picture->m_per_px > 0.0; }

bool is_square(const Figure& figure) { return std::any_of(figure.panels.begin(), figure.panels.end(), is_alike); }

int rows_of(const Figure& figure) {
  return (static_cast<int>(figure.panels.size()) + figure.columns - 1) / figure.columns;
}

/// A text in gnuplot's quotes; what would end it or begin a command is taken out.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    out += c == '"' || c == '\\' || c == '`' || c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

/// The known part of a map, and how many of its cells are drawn as one.
struct Crop {
  int column_begin = std::numeric_limits<int>::max();
  int row_begin = std::numeric_limits<int>::max();
  int column_end = 0;
  int row_end = 0;
  int cells_per_pixel = 1;
};

Crop known_part(const OccupancyMap& map) {
  Crop crop;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      if (map.at(column, row) != OccupancyMap::kUnknown) {
        crop.column_begin = std::min(crop.column_begin, column);
        crop.row_begin = std::min(crop.row_begin, row);
        crop.column_end = std::max(crop.column_end, column + 1);
        crop.row_end = row + 1;
      }
    }
  }
  const int side = std::max(crop.column_end - crop.column_begin, crop.row_end - crop.row_begin);
  crop.cells_per_pixel = std::max(1, (side + kMapPixelsMax - 1) / kMapPixelsMax);
  return crop;
}

/// The likeliest occupied of the cells that a pixel shows.
std::int8_t percent_of(const OccupancyMap& map, int first_column, int first_row, int cells_per_pixel) {
  std::int8_t highest = OccupancyMap::kUnknown;
  for (int row = first_row; row < std::min(first_row + cells_per_pixel, map.height_cells); ++row) {
    for (int column = first_column; column < std::min(first_column + cells_per_pixel, map.width_cells); ++column) {
      highest = std::max(highest, map.at(column, row));
    }
  }
  return highest;
}

int grey_of(std::int8_t percent) { return percent < 0 ? kUnknownGrey : 255 - percent * 255 / 100; }

std::string matrix_of(const OccupancyMap& map, const Crop& crop) {
  std::string text;
  const int step = crop.cells_per_pixel;
  for (int row = crop.row_begin; row < crop.row_end; row += step) {
    for (int column = crop.column_begin; column < crop.column_end; column += step) {
      fmt::format_to(std::back_inserter(text), "{} ", grey_of(percent_of(map, column, row, step)));
    }
    text += '\n';
  }
  return text;
}

std::string points_of(const Series& series) {
  std::string text;
  for (const PlotPoint& point : series.points) {
    if (std::isfinite(point.x) && std::isfinite(point.y)) {
      fmt::format_to(std::back_inserter(text), "{:.6g} {:.6g}\n", point.x, point.y);
    }
  }
  return text.empty() ? "NaN NaN\n" : text;
}

const char* style_of(Mark mark) {
  switch (mark) {
    case Mark::kLine:
      return "lines lw 1.5";
    case Mark::kPoints:
      return "points pt 7 ps 0.35";
    case Mark::kImpulses:
      return "impulses lw 1.2";
    case Mark::kBars:
      return "boxes fs solid 0.5 noborder";
  }
  return "lines";
}

std::string map_clause(const OccupancyMap& map, const Crop& crop, const std::string& block) {
  const double pixel_m = map.resolution_m * crop.cells_per_pixel;
  const double left_m = map.origin_x_m + crop.column_begin * map.resolution_m + pixel_m / 2.0;
  const double bottom_m = map.origin_y_m + crop.row_begin * map.resolution_m + pixel_m / 2.0;
  return fmt::format("{} matrix using ({:.6f}+$1*{:.6f}):({:.6f}+$2*{:.6f}):3 with image notitle", block, left_m,
                     pixel_m, bottom_m, pixel_m);
}

std::string picture_clause(const Underlay& picture, const std::string& file) {
  const double pixel_m = picture.m_per_px > 0.0 ? picture.m_per_px : 1.0;
  return fmt::format("{} binary filetype=png dx={:.6f} dy={:.6f} origin=({:.6f},{:.6f}) with rgbimage notitle",
                     in_quotes(file), pixel_m, pixel_m, picture.left_m + pixel_m / 2.0,
                     picture.bottom_m + pixel_m / 2.0);
}

std::string data_block(const std::string& name, const std::string& data) {
  return fmt::format("{} << EOD\n{}EOD\n", name, data);
}

/// Data and clauses of one panel's plot command.
struct PlotCommand {
  std::string data;
  std::vector<std::string> clauses;
};

PlotCommand plot_command(const Figure& figure, std::size_t number) {
  const Chart& panel = figure.panels[number];
  PlotCommand command;
  if (panel.map) {
    if (const Crop crop = known_part(*panel.map); crop.column_end > crop.column_begin) {
      const std::string block = fmt::format("$map{}", number);
      command.data += data_block(block, matrix_of(*panel.map, crop));
      command.clauses.push_back(map_clause(*panel.map, crop, block));
    }
  }
  if (panel.picture) {
    command.clauses.push_back(picture_clause(*panel.picture, picture_file(figure, number)));
  }
  for (const Series& series : panel.series) {
    const std::string block = fmt::format("$data{}_{}", number, command.clauses.size());
    command.data += data_block(block, points_of(series));
    command.clauses.push_back(fmt::format("{} using 1:2 with {} lc rgb \"#{:02x}{:02x}{:02x}\" title {}", block,
                                          style_of(series.mark), series.rgb.red, series.rgb.green, series.rgb.blue,
                                          in_quotes(series.label)));
  }
  if (command.clauses.empty()) {
    command.clauses.emplace_back("NaN notitle");
  }
  return command;
}

std::string axes_of(const Chart& panel) {
  std::string text = fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", in_quotes(panel.title),
                                 in_quotes(panel.x_label), in_quotes(panel.y_label));
  text += is_alike(panel) ? "set size ratio -1\nset key outside below\nset offsets graph 0.03, 0.03, 0.03, 0.03\n"
                          : "set size noratio\nset key top right\nset offsets 0, 0, graph 0.1, graph 0.05\n";
  text += has_axes(panel) ? "set border\nset tics\n" : "unset border\nunset tics\n";
  return text;
}

std::string plot_text(const PlotCommand& command) {
  std::string text = "plot ";
  for (const std::string& clause : command.clauses) {
    text += (clause == command.clauses.front() ? "" : ", \\\n  ") + clause;
  }
  return text + "\n";
}

}  // namespace

std::string picture_file(const Figure& figure, std::size_t panel) {
  return fmt::format("{}-{}.png", figure.name, panel + 1);
}

std::string gnuplot_script(const Figure& figure) {
  const int width_px = figure.columns * (is_square(figure) ? kSquareWidthPx : kPanelWidthPx);
  const int height_px = rows_of(figure) * (is_square(figure) ? kSquareHeightPx : kPanelHeightPx);
  std::string data;
  std::string draw = fmt::format("set multiplot layout {},{}\n", rows_of(figure), figure.columns);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const PlotCommand command = plot_command(figure, i);
    data += command.data;
    draw += axes_of(figure.panels[i]) + plot_text(command);
  }
  draw += "unset multiplot\n";
  const std::string size = fmt::format("size {},{} noenhanced", width_px, height_px);
  return fmt::format(
      "{}set grid lc rgb \"#dddddd\"\nset palette gray gamma 1.0\nset cbrange [0:255]\nunset colorbox\n"
      "set terminal svg {} font \"sans,12\" background rgb \"white\"\nset output \"{}.svg\"\n{}"
      "set terminal pngcairo {} font \"sans,9\"\nset output \"{}.png\"\n{}unset output\n",
      data, size, figure.name, draw, size, figure.name, draw);
}

}  // namespace odoless
