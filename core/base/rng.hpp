#pragma once

#include <cstdint>

namespace odoless {

/// PCG32 (XSH-RR) generator [oneill2014pcg; method 11] with distributions of our own, so that one seed gives the same
/// numbers with every standard library.
///
/// Thread: owned by one thread. Real time: no allocation, bounded time but for `normal`, whose rejection loop ends
/// after 1.27 rounds on average.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0);

  /// Uniform over all 32-bit numbers.
  [[nodiscard]] std::uint32_t next();

  /// Uniform over 0 .. bound-1; bound >= 1.
  [[nodiscard]] std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(next()) * bound) >> 32U);
  }

  /// Uniform in [0, 1).
  [[nodiscard]] double uniform() { return next() * 0x1p-32; }

  /// Uniform in [low, high).
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Gaussian with mean 0 and deviation 1 (polar method of Marsaglia).
  [[nodiscard]] double normal();

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_ = 0;
};

}  // namespace odoless
