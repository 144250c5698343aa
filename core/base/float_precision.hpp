#pragma once

namespace odoless {

/// Rounds to what a float can hold, as messages do. Volatile, for GCC 12 leaves the rounding out where it vectorises
/// two.
[[nodiscard]] inline double to_float_precision(double value) {
  const volatile auto rounded = static_cast<float>(value);
  return static_cast<double>(rounded);
}

}  // namespace odoless
