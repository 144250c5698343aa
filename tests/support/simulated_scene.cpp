#include "tests/support/simulated_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double distance_along_m(const std::pair<Point2, Point2>& wall, const Point2& from, const Point2& direction) {
  const Point2 along{wall.second.x_m - wall.first.x_m, wall.second.y_m - wall.first.y_m};
  const Point2 to_wall{wall.first.x_m - from.x_m, wall.first.y_m - from.y_m};
  const double cross = direction.x_m * along.y_m - direction.y_m * along.x_m;
  if (cross == 0.0) {
    return kInfinity;
  }
  const double t_m = (to_wall.x_m * along.y_m - to_wall.y_m * along.x_m) / cross;
  const double fraction = (to_wall.x_m * direction.y_m - to_wall.y_m * direction.x_m) / cross;
  return t_m > 0.0 && fraction >= 0.0 && fraction <= 1.0 ? t_m : kInfinity;
}

}  // namespace

void SimulatedScene::add_box(const Pose2& map_T_box, double width_m, double depth_m) {
  const double x_m = 0.5 * width_m;
  const double y_m = 0.5 * depth_m;
  const std::array<Point2, 4> corners{map_T_box * Point2{x_m, y_m}, map_T_box * Point2{-x_m, y_m},
                                      map_T_box * Point2{-x_m, -y_m}, map_T_box * Point2{x_m, -y_m}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    walls.emplace_back(corners[i], corners[(i + 1) % corners.size()]);
  }
}

double SimulatedScene::clearance_m(const Point2& p_map) const {
  double least_m = kInfinity;
  for (const auto& [a, b] : walls) {
    const double dx = b.x_m - a.x_m;
    const double dy = b.y_m - a.y_m;
    const double along = ((p_map.x_m - a.x_m) * dx + (p_map.y_m - a.y_m) * dy) / (dx * dx + dy * dy);
    const double t = std::clamp(along, 0.0, 1.0);
    least_m = std::min(least_m, std::hypot(p_map.x_m - a.x_m - t * dx, p_map.y_m - a.y_m - t * dy));
  }
  return least_m;
}

SimulatedScene cluttered_room() {
  SimulatedScene scene;
  scene.add_box({}, 9.0, 7.0);
  scene.add_box({3.9, 2.2, 0.0}, 1.2, 2.6);
  scene.add_box({-3.2, 2.6, 0.3}, 1.1, 0.6);
  scene.add_box({-2.9, -2.3, -0.5}, 0.8, 1.3);
  scene.add_box({2.4, -2.8, 0.1}, 1.5, 0.5);
  scene.add_box({0.4, 3.1, 0.0}, 0.9, 0.4);
  scene.add_box({1.9, 0.6, 0.8}, 0.3, 0.3);
  scene.add_box({-1.2, -0.4, 0.2}, 0.4, 0.2);
  return scene;
}

SimulatedScene pillar_field() {
  SimulatedScene scene;
  Rng rng(77);
  while (scene.walls.size() < 4 * 60) {
    const Pose2 map_T_box{rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0), rng.uniform(-1.5, 1.5)};
    if (std::hypot(map_T_box.x_m, map_T_box.y_m) > 1.0) {
      scene.add_box(map_T_box, 0.1, 0.1);
    }
  }
  return scene;
}

SimulatedScene corridor() {
  SimulatedScene scene;
  scene.walls = {{{-40.0, -1.0}, {40.0, -1.0}}, {{-40.0, 1.0}, {40.0, 1.0}}};
  return scene;
}

std::vector<float> ranges_m(const SimulatedScene& scene, const SimulatedLaser& laser, const Pose2& map_T_scan,
                            Rng& rng) {
  std::vector<float> out_m;
  for (int i = 0; i < laser.beams; ++i) {
    const double angle_rad = map_T_scan.yaw_rad + laser.start_angle_rad + i * laser.angle_step_rad;
    const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
    double range_m = kInfinity;
    for (const auto& wall : scene.walls) {
      range_m = std::min(range_m, distance_along_m(wall, {map_T_scan.x_m, map_T_scan.y_m}, direction));
    }
    range_m = range_m > laser.range_max_m ? kInfinity : std::max(0.06, range_m + laser.noise_sd_m * rng.normal());
    out_m.push_back(static_cast<float>(range_m));
  }
  return out_m;
}

ScanFrame sweep(const SimulatedScene& scene, const SimulatedLaser& laser, const Pose2& map_T_scan, Rng& rng,
                std::int64_t stamp_ns) {
  const std::vector<float> measured_m = ranges_m(scene, laser, map_T_scan, rng);
  ScanFrame scan(ScanParams{.beams_max = std::max(8, laser.beams)});
  const Errc error = scan.assign({.stamp_ns = stamp_ns,
                                  .start_angle_rad = laser.start_angle_rad,
                                  .angle_step_rad = laser.angle_step_rad,
                                  .ranges_m = measured_m});
  ODOLESS_CHECK(error == Errc::kOk);
  return scan;
}

}  // namespace odoless
