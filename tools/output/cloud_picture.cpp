#include "tools/output/cloud_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr Rgb kBackground{255, 255, 255};
constexpr int kSidePx = 1850;

/// The cuboid in which the outermost points lie; of none, the one around the origin.
struct Box {
  Point3 low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
             std::numeric_limits<double>::max()};
  Point3 high{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest(),
              std::numeric_limits<double>::lowest()};

  explicit Box(std::span<const Point3> points) {
    for (const Point3& p : points) {
      low = {std::min(low.x_m, p.x_m), std::min(low.y_m, p.y_m), std::min(low.z_m, p.z_m)};
      high = {std::max(high.x_m, p.x_m), std::max(high.y_m, p.y_m), std::max(high.z_m, p.z_m)};
    }
    if (points.empty()) {
      low = {-1.0, -1.0, -1.0};
      high = {1.0, 1.0, 1.0};
    }
  }
  [[nodiscard]] double width_m() const { return std::max(high.x_m - low.x_m, 1.0); }
  [[nodiscard]] double depth_m() const { return std::max(high.y_m - low.y_m, 1.0); }
  [[nodiscard]] Point3 middle() const {
    return {(low.x_m + high.x_m) / 2.0, (low.y_m + high.y_m) / 2.0, (low.z_m + high.z_m) / 2.0};
  }
};

/// A picture in which the nearest point wins.
class DepthCanvas {
 public:
  DepthCanvas(int width_px, int height_px)
      : canvas_(width_px, height_px, kBackground),
        depths_m_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px),
                  std::numeric_limits<float>::max()) {}

  /// A square of `side_px`.
  void dot(Pixel at, int side_px, double depth_m, Rgb colour) {
    for (int row = at.row_px; row < at.row_px + side_px; ++row) {
      for (int column = at.column_px; column < at.column_px + side_px; ++column) {
        set({column, row}, static_cast<float>(depth_m), colour);
      }
    }
  }
  [[nodiscard]] Canvas& canvas() { return canvas_; }

 private:
  void set(Pixel at, float depth_m, Rgb colour) {
    if (!canvas_.contains(at)) {
      return;
    }
    float& nearest_m = depths_m_[static_cast<std::size_t>(at.row_px) * static_cast<std::size_t>(canvas_.width_px()) +
                                 static_cast<std::size_t>(at.column_px)];
    if (depth_m < nearest_m) {
      nearest_m = depth_m;
      canvas_.set(at, colour);
    }
  }

  Canvas canvas_;
  std::vector<float> depths_m_;
};

/// An eye that looks at the middle of a box from its lower left corner's side.
class Eye {
 public:
  Eye(const Box& box, int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {
    constexpr double kAzimuthRad = -2.2;
    constexpr double kElevationRad = 40.0 * std::numbers::pi / 180.0;
    const double distance_m = 1.6 * math::hypot(box.width_m(), box.depth_m());
    const Eigen::Vector3d back(math::cos(kElevationRad) * math::cos(kAzimuthRad),
                               math::cos(kElevationRad) * math::sin(kAzimuthRad), math::sin(kElevationRad));
    const Point3 middle = box.middle();
    place_m_ = Eigen::Vector3d(middle.x_m, middle.y_m, middle.z_m) + distance_m * back;
    right_ = Eigen::Vector3d::UnitZ().cross(back).normalized();
    up_ = back.cross(right_);
    forward_ = -back;
    focal_px_ = 1.15 * width_px;
  }

  struct Seen {
    Pixel at;
    double depth_m = 0.0;
    double px_per_m = 0.0;
  };
  /// Points behind the eye are seen off the picture.
  [[nodiscard]] Seen see(const Point3& point) const {
    const Eigen::Vector3d to = Eigen::Vector3d(point.x_m, point.y_m, point.z_m) - place_m_;
    const double depth_m = to.dot(forward_);
    if (!(depth_m > 0.1)) {
      return {{-1, -1}, 0.0, 0.0};
    }
    const double px_per_m = focal_px_ / depth_m;
    const double column_px = width_px_ / 2.0 + px_per_m * to.dot(right_);
    const double row_px = height_px_ / 2.0 - px_per_m * to.dot(up_);
    const bool is_inside = column_px >= 0.0 && column_px < width_px_ && row_px >= 0.0 && row_px < height_px_;
    return {is_inside ? Pixel{static_cast<int>(column_px), static_cast<int>(row_px)} : Pixel{-1, -1}, depth_m,
            px_per_m};
  }

 private:
  int width_px_;
  int height_px_;
  Eigen::Vector3d place_m_;
  Eigen::Vector3d right_;
  Eigen::Vector3d up_;
  Eigen::Vector3d forward_;
  double focal_px_;
};

std::vector<Point3> below(std::span<const Point3> points, double cut_m) {
  std::vector<Point3> kept;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kept),
               [cut_m](const Point3& p) { return p.z_m <= cut_m; });
  return kept;
}

/// How large a plan is.
struct PlanSize {
  int side_px;
  int width_min_px = 1;
};

CloudPlan render_plan(std::span<const Point3> points, const HeightColours& colours, double cut_m,
                      const PlanSize& size) {
  const std::vector<Point3> kept = below(points, cut_m);
  const Box box(kept);
  const double px_per_m = std::min(size.side_px / std::max(box.width_m(), box.depth_m()), 60.0);
  const int width_px = static_cast<int>(box.width_m() * px_per_m) + 1;
  const int height_px = static_cast<int>(box.depth_m() * px_per_m) + 1;
  DepthCanvas picture(std::max(width_px, size.width_min_px), height_px);
  for (const Point3& p : kept) {
    const Pixel at{static_cast<int>((p.x_m - box.low.x_m) * px_per_m),
                   height_px - 1 - static_cast<int>((p.y_m - box.low.y_m) * px_per_m)};
    picture.dot(at, 2, box.high.z_m - p.z_m, colours.at(p.z_m));
  }
  return {std::move(picture.canvas()), {box.low.x_m, box.low.y_m}, px_per_m};
}

ColourBar heights_of(const HeightColours& colours) {
  return {
      .title = "height in m", .low_m = colours.low_m(), .high_m = colours.high_m(), .colour = [colours](double z_m) {
        return colours.at(z_m);
      }};
}

}  // namespace

CloudPlan plan_of_cloud(std::span<const Point3> points, const HeightColours& colours, double cut_m, int side_px) {
  return render_plan(points, colours, cut_m, {.side_px = side_px});
}

Drawing draw_cloud_from_above(std::span<const Point3> points, const HeightColours& colours, double cut_m) {
  CloudPlan plan = render_plan(points, colours, cut_m, {.side_px = kSidePx, .width_min_px = 400});
  return draw_plan({.title = fmt::format("3D map from above, up to {:.1f} m high", std::min(cut_m, colours.high_m())),
                    .picture = std::move(plan.canvas),
                    .low = plan.low,
                    .px_per_m = plan.px_per_m,
                    .bar = heights_of(colours)});
}

Canvas draw_cloud_in_perspective(std::span<const Point3> points, const HeightColours& colours, double cut_m,
                                 int width_px) {
  constexpr double kDotM = 0.05;
  const int height_px = width_px * 5 / 8;
  const std::vector<Point3> kept = below(points, cut_m);
  const Eye eye(Box(kept), width_px, height_px);
  DepthCanvas picture(width_px, height_px);
  for (const Point3& p : kept) {
    const Eye::Seen seen = eye.see(p);
    const int side_px = std::clamp(static_cast<int>(std::ceil(kDotM * seen.px_per_m)), 1, 6);
    if (seen.at.column_px >= 0) {
      picture.dot(seen.at, side_px, seen.depth_m, colours.at(p.z_m));
    }
  }
  return picture.canvas();
}

Drawing draw_cloud_with_heights(std::span<const Point3> points, const HeightColours& colours, double cut_m,
                                const std::string& title) {
  constexpr int kTop_px = 64;
  constexpr int kBarLeft_px = 24;
  Canvas picture = draw_cloud_in_perspective(points, colours, cut_m);
  Drawing drawing(picture.width_px(), picture.height_px() + kTop_px, kBackground);
  drawing.image({0, kTop_px}, std::move(picture));
  drawing.text({static_cast<double>(kBarLeft_px), 28.0}, title);
  draw_colour_bar(heights_of(colours), kBarLeft_px, kTop_px, drawing.height_px(), drawing);
  return drawing;
}

double below_ceiling_m(const HeightColours& colours) { return colours.high_m() - 0.3; }

}  // namespace odoless
