#include "tools/output/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr Rgb kWhite{255, 255, 255};
constexpr Rgb kBlack{0, 0, 0};
constexpr Rgb kAxisColour{60, 60, 60};
constexpr Stroke kGrid{.colour = {0, 60, 140}, .width_px = 1.0, .opacity = 0.16};
constexpr Stroke kFrame{.colour = kAxisColour, .width_px = 1.0};
constexpr double kStartRadius_px = 6.0;

/// The largest of 1, 2 and 5 times a power of ten that is not above.
double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value) + 1e-9));
  const double rest = value / power * (1.0 + 1e-9);
  return power * (rest >= 5.0 ? 5.0 : rest >= 2.0 ? 2.0 : 1.0);
}

/// The picture within the drawing, and where points of the map are on it.
class Frame {
 public:
  explicit Frame(const Plan& plan) : plan_(plan) {}

  [[nodiscard]] double left_px() const { return kPlanLeft_px; }
  [[nodiscard]] double right_px() const { return kPlanLeft_px + plan_.picture.width_px(); }
  [[nodiscard]] double top_px() const { return kPlanTop_px; }
  [[nodiscard]] double bottom_px() const { return kPlanTop_px + plan_.picture.height_px(); }
  [[nodiscard]] double x_px(double x_m) const { return left_px() + (x_m - plan_.low.x_m) * plan_.px_per_m; }
  [[nodiscard]] double y_px(double y_m) const { return bottom_px() - (y_m - plan_.low.y_m) * plan_.px_per_m; }

  [[nodiscard]] std::optional<Spot> find(const Pose2& point) const {
    const Spot place{x_px(point.x_m), y_px(point.y_m)};
    const bool is_inside =
        place.x_px >= left_px() && place.x_px <= right_px() && place.y_px >= top_px() && place.y_px <= bottom_px();
    return is_inside ? std::optional(place) : std::nullopt;
  }

 private:
  const Plan& plan_;
};

void draw_axes(const Plan& plan, const Frame& frame, Drawing& drawing) {
  constexpr double kTicksApart_px = 90.0;
  constexpr TextStyle kNumber{.height_px = 10.0, .align = Align::kMiddle, .colour = kAxisColour};
  constexpr TextStyle kSide{.height_px = 10.0, .align = Align::kRight, .colour = kAxisColour};
  const double step_m = round_down(kTicksApart_px / plan.px_per_m);
  const auto number = [step_m](double value_m) {
    return fmt::format("{:.{}f}", value_m + 0.0, step_m >= 1.0 ? 0 : step_m >= 0.1 ? 1 : 2);
  };
  const auto ticks = [step_m](double begin_m, double length_m, auto draw) {
    const auto first = static_cast<std::int64_t>(std::ceil(begin_m / step_m - 1e-9));
    for (std::int64_t i = first; static_cast<double>(i) * step_m <= begin_m + length_m + 1e-9; ++i) {
      draw(static_cast<double>(i) * step_m);
    }
  };
  ticks(plan.low.x_m, plan.picture.width_px() / plan.px_per_m, [&](double x_m) {
    const double x_px = frame.x_px(x_m);
    drawing.line(std::array{Spot{x_px, frame.top_px()}, Spot{x_px, frame.bottom_px()}}, kGrid);
    drawing.text({x_px, frame.bottom_px() + 17.0}, number(x_m), kNumber);
  });
  ticks(plan.low.y_m, plan.picture.height_px() / plan.px_per_m, [&](double y_m) {
    const double y_px = frame.y_px(y_m);
    drawing.line(std::array{Spot{frame.left_px(), y_px}, Spot{frame.right_px(), y_px}}, kGrid);
    drawing.text({frame.left_px() - 8.0, y_px + 5.0}, number(y_m), kSide);
  });
  drawing.line(std::array{Spot{frame.left_px(), frame.top_px()}, Spot{frame.right_px(), frame.top_px()},
                          Spot{frame.right_px(), frame.bottom_px()}, Spot{frame.left_px(), frame.bottom_px()},
                          Spot{frame.left_px(), frame.top_px()}},
               kFrame);
  drawing.text({frame.right_px(), frame.bottom_px() + 40.0}, "x in m", kSide);
  drawing.text({frame.left_px() - 8.0, frame.top_px() - 10.0}, "y in m", kSide);
}

void draw_path(const Frame& frame, const ColouredPath& path, Drawing& drawing) {
  std::vector<Spot> piece;
  const auto finish = [&] {
    if (piece.size() == 1) {  // the only one that can be seen
      drawing.disc(piece.front(), 2.0, path.rgb);
    } else if (!piece.empty()) {
      drawing.line(piece, {.colour = path.rgb});
    }
    piece.clear();
  };
  for (const Pose2& pose : path.poses) {
    if (const std::optional<Spot> place = frame.find(pose)) {
      piece.push_back(*place);
    } else {
      finish();
    }
  }
  finish();
  const std::optional<Spot> start = path.poses.empty() ? std::nullopt : frame.find(path.poses.front());
  if (start) {
    drawing.disc(*start, kStartRadius_px, kWhite);
    drawing.disc(*start, kStartRadius_px - 2.0, path.rgb);
  }
}

/// A line of the path's colour and its name, one after the other.
void draw_legend(const Plan& plan, const Frame& frame, Drawing& drawing) {
  constexpr double kSample_px = 26.0;
  constexpr double kLetter_px = 9.0;
  double x_px = frame.left_px();
  const double y_px = frame.top_px() - 10.0;
  for (const ColouredPath& path : plan.paths) {
    if (!path.name.empty()) {
      drawing.line(std::array{Spot{x_px, y_px - 4.0}, Spot{x_px + kSample_px, y_px - 4.0}},
                   {.colour = path.rgb, .width_px = 3.0});
      drawing.text({x_px + kSample_px + 7.0, y_px}, path.name, {.height_px = 10.0});
      x_px += kSample_px + 26.0 + kLetter_px * static_cast<double>(path.name.size());
    }
  }
}

void draw_scale_bar(const Plan& plan, const Frame& frame, Drawing& drawing) {
  constexpr double kHeight_px = 5.0;
  const double bar_m = scale_bar_m(plan.picture.width_px() / plan.px_per_m);
  const Spot begin{frame.left_px(), frame.bottom_px() + 36.0};
  drawing.rectangle(begin, {begin.x_px + bar_m * plan.px_per_m, begin.y_px + kHeight_px}, kBlack);
  drawing.text({begin.x_px + bar_m * plan.px_per_m + 8.0, begin.y_px + 8.0}, fmt::format("{:g} m", bar_m),
               {.height_px = 11.0});
}

}  // namespace

double scale_bar_m(double width_m) { return round_down(0.25 * width_m); }

Drawing draw_plan(const Plan& plan) {
  const int right_px = plan.bar ? kPlanBarRight_px : kPlanRight_px;
  Drawing drawing(kPlanLeft_px + plan.picture.width_px() + right_px,
                  kPlanTop_px + plan.picture.height_px() + kPlanBottom_px, kWhite);
  const Frame frame(plan);
  drawing.image({kPlanLeft_px, kPlanTop_px}, plan.picture);
  draw_axes(plan, frame, drawing);
  for (const ColouredPath& path : plan.paths) {
    draw_path(frame, path, drawing);
  }
  drawing.text({frame.left_px(), 28.0}, plan.title, {.height_px = 14.0});
  draw_legend(plan, frame, drawing);
  draw_scale_bar(plan, frame, drawing);
  if (plan.bar) {
    draw_colour_bar(*plan.bar, static_cast<int>(frame.right_px()) + 16, kPlanTop_px,
                    static_cast<int>(frame.bottom_px()), drawing);
  }
  return drawing;
}

void draw_colour_bar(const ColourBar& bar, int left_px, int top_px, int bottom_px, Drawing& drawing) {
  constexpr int kWidth_px = 16;
  constexpr int kLabels = 5;
  const int height_px = std::clamp(bottom_px - top_px, 2, 400);
  Canvas picture(kWidth_px, height_px, {});
  for (int row = 0; row < height_px; ++row) {
    const double share = 1.0 - static_cast<double>(row) / (height_px - 1);
    for (int column = 0; column < kWidth_px; ++column) {
      picture.set({column, row}, bar.colour(bar.low_m + share * (bar.high_m - bar.low_m)));
    }
  }
  drawing.image({left_px, top_px}, std::move(picture));
  for (int i = 0; i < kLabels; ++i) {
    const double share = static_cast<double>(i) / (kLabels - 1);
    const double height_m =
        std::round(100.0 * (bar.low_m + share * (bar.high_m - bar.low_m))) / 100.0 + 0.0;  // no -0.00
    drawing.text({left_px + kWidth_px + 6.0, top_px + (1.0 - share) * (height_px - 1) + 5.0},
                 fmt::format("{:.2f}", height_m), {.height_px = 10.0});
  }
  drawing.text({static_cast<double>(left_px), top_px - 16.0}, bar.title, {.height_px = 10.0});
}

void write_drawing(const std::filesystem::path& path, const Drawing& drawing) {
  write_whole_file(path, drawing.pixels().png());
  write_whole_file(std::filesystem::path(path).replace_extension(".svg"), drawing.svg());
}

}  // namespace odoless
