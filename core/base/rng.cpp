#include "core/base/rng.hpp"

#include <bit>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {
constexpr std::uint64_t kMultiplier = 6364136223846793005ULL;
}  // namespace

Rng::Rng(std::uint64_t seed, std::uint64_t stream) : increment_((stream << 1U) | 1U) {
  static_cast<void>(next());
  state_ += seed;
  static_cast<void>(next());
}

std::uint32_t Rng::next() {
  const std::uint64_t old = state_;
  state_ = old * kMultiplier + increment_;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  return std::rotr(shifted, static_cast<int>(old >> 59U));
}

double Rng::normal() {
  double u = 0.0;
  double s = 0.0;
  do {
    u = uniform(-1.0, 1.0);
    const double v = uniform(-1.0, 1.0);
    s = u * u + v * v;
  } while (s >= 1.0 || s == 0.0);
  return u * std::sqrt(-2.0 * math::log(s) / s);
}

}  // namespace odoless
