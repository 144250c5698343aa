#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/grid/occupancy_map.hpp"
#include "tools/output/canvas.hpp"

namespace odoless {

/// A point of a plot, in the units of its panel's axes.
struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

enum class Mark { kLine, kPoints, kImpulses, kBars };

struct Series {
  std::string label;  ///< in the legend
  Mark mark = Mark::kLine;
  Rgb rgb;
  std::vector<PlotPoint> points;
};

/// A picture that lies beneath a chart's series.
struct Underlay {
  Canvas canvas;
  double left_m = 0.0;  ///< of its lower left corner, in the chart's axes
  double bottom_m = 0.0;
  double m_per_px = 0.0;  ///< 0: a view into space, whose chart has no axes
};

/// One pair of axes.
struct Chart {
  std::string title{};
  std::string x_label{};  ///< with unit
  std::string y_label{};
  std::vector<Series> series{};
  std::optional<OccupancyMap> map{};  ///< beneath the series, its known part alone; x and y are then metres, alike long
  std::optional<Underlay> picture{};  ///< the same of a picture
  bool alike = false;                 ///< both axes are metres of the same length
};

/// Panels side by side, row by row.
struct Figure {
  std::string name{};  ///< the files', without extension
  std::string caption{};
  int columns = 1;
  std::vector<Chart> panels{};
};

constexpr Rgb kRed{220, 50, 32};
constexpr Rgb kBlue{0, 90, 181};
constexpr Rgb kGreen{26, 133, 80};
constexpr Rgb kOrange{230, 138, 0};

/// The file of a panel's picture, of which the script expects the bytes.
[[nodiscard]] std::string picture_file(const Figure& figure, std::size_t panel);

/// The figure as a script of gnuplot, which writes NAME.svg and NAME.png into its current directory, and finds there
/// the pictures of its panels.
[[nodiscard]] std::string gnuplot_script(const Figure& figure);

/// Fails unless gnuplot can be run. @throws UserError (69) that says what to install.
void check_gnuplot();

/// Writes NAME.gp, NAME.svg, NAME.png and the panels' pictures into a folder. @throws what check_gnuplot throws,
/// IoError where drawing fails.
void write_figure(const std::filesystem::path& folder, const Figure& figure);

}  // namespace odoless
