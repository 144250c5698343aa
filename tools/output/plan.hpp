#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/output/drawing.hpp"

namespace odoless {

/// A path over a plan, with its name in the legend; empty: none.
struct ColouredPath {
  std::vector<Pose2> poses{};  ///< map frame
  Rgb rgb{};
  std::string name{};
};

/// What the colours of a picture mean: a bar beside it, from low to high.
struct ColourBar {
  std::string title{};
  double low_m = 0.0;
  double high_m = 1.0;
  std::function<Rgb(double)> colour{};
};

/// A picture of an area seen from above, to scale, and what is drawn around it: a title, axes in metres with a grid, a
/// legend, a bar of a round length, and a colour bar where there is one. The map's x is to the right.
struct Plan {
  std::string title{};
  Canvas picture;
  Point2 low{};  ///< the picture's lower left corner, map frame
  double px_per_m = 1.0;
  std::vector<ColouredPath> paths{};  ///< in their order; what is off the picture is not drawn
  std::optional<ColourBar> bar{};
};

/// Room around the picture.
inline constexpr int kPlanLeft_px = 64;
inline constexpr int kPlanTop_px = 64;
inline constexpr int kPlanRight_px = 24;
inline constexpr int kPlanBarRight_px = 110;  ///< where there is a colour bar
inline constexpr int kPlanBottom_px = 64;

/// A bar of this length, 1, 2 or 5 times a power of ten, is between a tenth and a quarter of the picture's width.
[[nodiscard]] double scale_bar_m(double width_m);

[[nodiscard]] Drawing draw_plan(const Plan& plan);

/// A colour bar of heights at the right of `drawing`, between two rows.
void draw_colour_bar(const ColourBar& bar, int left_px, int top_px, int bottom_px, Drawing& drawing);

/// `path` as PNG, and beside it the same as SVG. @throws CannotCreateError, IoError.
void write_drawing(const std::filesystem::path& path, const Drawing& drawing);

}  // namespace odoless
