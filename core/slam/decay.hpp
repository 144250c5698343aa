#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>

namespace odoless {

/// exp(-x) for x >= 0, within 4e-7 of the true value relatively; 0 beyond 80. The same bits on every processor, which
/// the library's exp does not promise, and cheap enough for a beam model.
[[nodiscard]] inline float decay(float x) {
  constexpr float kLog2E = 1.442695041F;
  constexpr float kLn2 = 0.6931471806F;
  constexpr float kRootHalf = 0.7071067812F;
  if (!(x < 80.0F)) {
    return 0.0F;
  }
  const float y = x * kLog2E;
  const auto whole = static_cast<std::int32_t>(y);
  const float u = (static_cast<float>(whole) + 0.5F - y) * kLn2;  // exp(-x) = 2^-whole * sqrt(1/2) * exp(u), |u| < 0.35
  float series = 1.0F + u * (1.0F / 7.0F);                        // Taylor, innermost term first
  for (const float inverse : {1.0F / 6.0F, 1.0F / 5.0F, 1.0F / 4.0F, 1.0F / 3.0F, 1.0F / 2.0F, 1.0F}) {
    series = 1.0F + u * inverse * series;
  }
  const auto power = std::bit_cast<float>(static_cast<std::uint32_t>(127 - whole) << 23U);
  return power * kRootHalf * series;
}

}  // namespace odoless
