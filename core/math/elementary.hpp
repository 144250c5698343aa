#pragma once

#include <cmath>

/// Elementary functions that give the same bits on every processor, with every compiler and every C library, which the
/// library's do not promise: made of +, -, *, / and sqrt alone, which IEEE 754 rounds in one way.
/// `conventions.elementary` keeps the library's own out of the core; what IEEE 754 makes exact (sqrt, fma, floor,
/// round, remainder) may stay there.
///
/// Errors are in units of the last place (ulp), as `tests/core/math/elementary_test` holds them. NaN gives NaN; no
/// errno, no floating-point traps, rounding to nearest expected.
///
/// Real time: no allocation, no loop, bounded time.
namespace odoless::math {

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

/// Both within 0.9 ulp up to |x| = 25000, so 4000 turns; beyond, x is first taken modulo the double next to 2 pi.
/// Infinity gives NaN.
[[nodiscard]] SinCos sincos(double x_rad);
[[nodiscard]] double sin(double x_rad);
[[nodiscard]] double cos(double x_rad);

/// sin / cos: within 2.5 ulp, in the range of those.
[[nodiscard]] double tan(double x_rad);

/// Within 0.6 ulp for quotients and arguments whose powers of two are within +-900, infinity, and zero with its sign.
[[nodiscard]] double atan2(double y, double x);
[[nodiscard]] double atan(double x);

/// Within 2 ulp; NaN beyond [-1, 1].
[[nodiscard]] double asin(double x);

/// Within 0.6 ulp, 1 ulp of the smallest number where the result is denormal; 0 and infinity where it has no place.
[[nodiscard]] double exp(double x);

/// exp(x) - 1 within 2.5 ulp, also near 0.
[[nodiscard]] double expm1(double x);

/// Within 0.6 ulp, of denormal numbers too; -infinity at 0, NaN below.
[[nodiscard]] double log(double x);

/// log(1 + x) within 1.5 ulp, also near 0.
[[nodiscard]] double log1p(double x);

/// The integral of the Gaussian, within 2 ulp.
[[nodiscard]] double erf(double x);

/// Within 1.5 ulp where the squares of both neither overflow nor vanish: 1e-150 to 1e150, and 0.
[[nodiscard]] inline double hypot(double x, double y) { return std::sqrt(x * x + y * y); }

}  // namespace odoless::math
