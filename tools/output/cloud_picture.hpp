#pragma once

#include <filesystem>
#include <span>

#include "tools/output/cloud_files.hpp"
#include "tools/output/plan.hpp"

namespace odoless {

/// A cloud from straight above, to scale; of a plan, the lower left corner is at `low`.
struct CloudPlan {
  Canvas canvas;
  Point2 low{};
  double px_per_m = 1.0;
};

/// A cloud from straight above; nearer (higher) points hide others. What is above `cut_m` is left out: a ceiling would
/// hide all. Its longer side has at most about `side_px` pixels, and at most 60 for a metre.
[[nodiscard]] CloudPlan plan_of_cloud(std::span<const Point3> points, const HeightColours& colours, double cut_m,
                                      int side_px);

/// The same as a drawing with axes and the colours' heights. At most 2048 pixels wide and high.
[[nodiscard]] Drawing draw_cloud_from_above(std::span<const Point3> points, const HeightColours& colours, double cut_m);

/// In perspective, seen from a corner at 40 deg above the horizon, from where all of it can be seen; 8 to 5.
constexpr int kPerspectiveWidthPx = 1600;
[[nodiscard]] Canvas draw_cloud_in_perspective(std::span<const Point3> points, const HeightColours& colours,
                                               double cut_m, int width_px = kPerspectiveWidthPx);

/// The same as a drawing with a title and the colours' heights.
[[nodiscard]] Drawing draw_cloud_with_heights(std::span<const Point3> points, const HeightColours& colours,
                                              double cut_m, const std::string& title);

/// Where to cut a cloud of rooms: 0.3 m beneath the highest points.
[[nodiscard]] double below_ceiling_m(const HeightColours& colours);

}  // namespace odoless
