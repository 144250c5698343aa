#pragma once

#include <array>
#include <cstddef>

/// Tables of the elementary functions, made while compiling: no list of digits to copy, none to get wrong.
namespace odoless::math {

/// The sum of two doubles, the second at most half a unit of the first's last place: about 106 bits [dekker1971float;
/// method 11].
struct DoubleDouble {
  double high = 0.0;
  double low = 0.0;
};

/// a + b without loss; |a| >= |b|, or a = 0.
constexpr DoubleDouble fast_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a * b without loss.
constexpr DoubleDouble product(double a, double b) {
  constexpr double kSplit = 0x1p27 + 1.0;
  const double a_high = kSplit * a - (kSplit * a - a);
  const double b_high = kSplit * b - (kSplit * b - b);
  const double a_low = a - a_high;
  const double b_low = b - b_high;
  const double high = a * b;
  return {high, a_low * b_low - (((high - a_high * b_high) - a_low * b_high) - a_high * b_low)};
}

constexpr DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const double sum = a.high + b.high;
  const double b_part = sum - a.high;
  const double lost = (a.high - (sum - b_part)) + (b.high - b_part);
  return fast_sum(sum, lost + (a.low + b.low));
}

constexpr DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble whole = product(a.high, b.high);
  return fast_sum(whole.high, whole.low + (a.high * b.low + a.low * b.high));
}

constexpr DoubleDouble operator/(const DoubleDouble& a, double b) {
  const double quotient = a.high / b;
  const DoubleDouble back = product(quotient, b);
  return fast_sum(quotient, ((a.high - back.high) - back.low + a.low) / b);
}

inline constexpr DoubleDouble kLn2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};

}  // namespace odoless::math
