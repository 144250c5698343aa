#include "tests/support/simulated_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kHalfWidth_m = 3.0;
constexpr double kHalfHeight_m = 2.0;
constexpr Point2 kPillar{1.4, 0.9};
constexpr double kPillarRadius_m = 0.3;
constexpr std::int64_t kPeriod_ns = 100'000'000;

double distance_to_walls_m(const Pose2& laser, double c, double s) {
  const double to_x_m = ((c > 0.0 ? kHalfWidth_m : -kHalfWidth_m) - laser.x_m) / c;
  const double to_y_m = ((s > 0.0 ? kHalfHeight_m : -kHalfHeight_m) - laser.y_m) / s;
  return std::min(to_x_m, to_y_m);
}

double distance_to_pillar_m(const Pose2& laser, double c, double s) {
  const double along_m = c * (kPillar.x_m - laser.x_m) + s * (kPillar.y_m - laser.y_m);
  const double beside_m = -s * (kPillar.x_m - laser.x_m) + c * (kPillar.y_m - laser.y_m);
  if (along_m < 0.0 || std::abs(beside_m) > kPillarRadius_m) {
    return std::numeric_limits<double>::infinity();
  }
  return along_m - std::sqrt(kPillarRadius_m * kPillarRadius_m - beside_m * beside_m);
}

}  // namespace

SimulatedRoom::SimulatedRoom(std::uint64_t seed, int beams)
    : rng_(seed), beams_(beams), scan_(ScanParams{.beams_max = std::max(8, beams), .range_max_m = 20.0}) {
  ranges_m_.resize(static_cast<std::size_t>(beams));
}

void SimulatedRoom::step() {
  if (steps_++ > 0) {
    const Pose2 step{0.06, 0.0, 0.1 + 0.05 * std::sin(0.3 * steps_)};
    map_T_scan_ = map_T_scan_ * step;
    motion_ = Motion::between(scan_.stamp_ns(), scan_.stamp_ns() + kPeriod_ns,
                              step * Pose2{0.005 * rng_.normal(), 0.005 * rng_.normal(), 0.004 * rng_.normal()});
  }
  sweep();
}

float SimulatedRoom::range_m(double angle_rad) {
  if (rng_.below(25) == 0) {
    return rng_.below(2) == 0 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  }
  const double c = std::cos(map_T_scan_.yaw_rad + angle_rad);
  const double s = std::sin(map_T_scan_.yaw_rad + angle_rad);
  const double true_m = std::min(distance_to_walls_m(map_T_scan_, c, s), distance_to_pillar_m(map_T_scan_, c, s));
  return static_cast<float>(true_m + 0.01 * rng_.normal());
}

void SimulatedRoom::sweep() {
  const double step_rad = 1.5 * std::numbers::pi / (beams_ - 1);
  const double start_rad = -0.75 * std::numbers::pi;
  for (int i = 0; i < beams_; ++i) {
    ranges_m_[static_cast<std::size_t>(i)] = range_m(start_rad + i * step_rad);
  }
  const Errc error = scan_.assign({.stamp_ns = motion_.to_stamp_ns,
                                   .start_angle_rad = start_rad,
                                   .angle_step_rad = step_rad,
                                   .ranges_m = ranges_m_});
  ODOLESS_CHECK(error == Errc::kOk);
}

}  // namespace odoless
