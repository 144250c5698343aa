#include "tools/output/scale_bar.hpp"

#include <cmath>

namespace odoless {

void draw_scale_bar(double px_per_m, Canvas& canvas) {
  constexpr Rgb kWhite{255, 255, 255};
  constexpr Rgb kBlack{0, 0, 0};
  constexpr double kLongBarFromM = 40.0;
  constexpr int kLeftPx = 10;
  constexpr int kBarPx = 4;
  const bool is_long = canvas.width_px() / px_per_m >= kLongBarFromM;
  const int length_px = static_cast<int>(std::lround((is_long ? 10.0 : 5.0) * px_per_m));
  const int top_px = canvas.height_px() - kScaleBarHeightPx;
  canvas.rectangle({0, top_px}, {canvas.width_px() - 1, canvas.height_px() - 1}, kWhite);
  canvas.text({kLeftPx, top_px + 6}, is_long ? "10 m" : "5 m", kBlack);
  canvas.rectangle({kLeftPx, top_px + 26}, {kLeftPx + length_px - 1, top_px + 26 + kBarPx - 1}, kBlack);
}

}  // namespace odoless
