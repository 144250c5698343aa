#pragma once

#include <filesystem>
#include <span>

#include "tools/output/canvas.hpp"
#include "tools/output/cloud_files.hpp"

namespace odoless {

/// A cloud from straight above, to scale, with a bar of 5 or 10 m; nearer (higher) points hide others. What is above
/// `cut_m` is left out: a ceiling would hide all. At most 2048 pixels wide and high.
[[nodiscard]] Canvas draw_cloud_from_above(std::span<const Point3> points, const HeightColours& colours, double cut_m);

/// The same in perspective, seen from a corner at 40 deg above the horizon, from where all of it can be seen.
[[nodiscard]] Canvas draw_cloud_in_perspective(std::span<const Point3> points, const HeightColours& colours,
                                               double cut_m);

/// Where to cut a cloud of rooms: 0.3 m beneath the highest points.
[[nodiscard]] double below_ceiling_m(const HeightColours& colours);

}  // namespace odoless
