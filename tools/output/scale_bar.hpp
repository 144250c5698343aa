#pragma once

#include "tools/output/canvas.hpp"

namespace odoless {

constexpr int kScaleBarHeightPx = 40;

/// Draws a bar of 5 m, or 10 m where the picture is wider than 40 m, with its length in the lowest kScaleBarHeightPx
/// rows, which are made white.
void draw_scale_bar(double px_per_m, Canvas& canvas);

}  // namespace odoless
