#include "core/slam/kld_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/base/check.hpp"

namespace odoless {

KldSampling::KldSampling(int particles_max) : keys_(static_cast<std::size_t>(particles_max)) {}

int KldSampling::bins(std::span<const Pose2> poses, std::span<const double> weights) {
  constexpr double kSide_m = 0.1;
  constexpr double kSide_rad = 2.0 * std::numbers::pi / 180.0;
  constexpr double kFar = 1e9;
  ODOLESS_CHECK(poses.size() <= keys_.size() && poses.size() == weights.size());
  const auto bin = [=](double x) { return static_cast<int>(std::floor(std::clamp(x, -kFar, kFar))); };
  const double kept = 0.5 / static_cast<double>(poses.size());
  auto end = keys_.begin();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weights[i] >= kept) {
      *end++ = {bin(poses[i].x_m / kSide_m), bin(poses[i].y_m / kSide_m), bin(poses[i].yaw_rad / kSide_rad)};
    }
  }
  std::sort(keys_.begin(), end);
  return static_cast<int>(std::distance(keys_.begin(), std::unique(keys_.begin(), end)));
}

int KldSampling::particles_for(int bins, double error) {
  constexpr double kQuantile = 2.326;  // of the standard normal distribution, for 0.99
  constexpr double kMost = 1e9;
  if (bins <= 1) {
    return 1;
  }
  const double free = bins - 1;
  const double share = 2.0 / (9.0 * free);
  const double root = 1.0 - share + std::sqrt(share) * kQuantile;
  const double particles = std::ceil(free / (2.0 * error) * root * root * root);
  return static_cast<int>(std::clamp(particles, 1.0, kMost));
}

}  // namespace odoless
