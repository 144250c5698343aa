#include "core/math/elementary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kArguments = 200'000;

// The reference has at least 11 bits more than a double.
static_assert(std::numeric_limits<long double>::digits >= 64);

// In units of the last place of a double that is next to the reference.
double error_ulp(double value, long double reference) {
  const double next = std::abs(static_cast<double>(reference));
  const double unit = std::nextafter(next, kInfinity) - next;
  return std::abs(static_cast<double>((static_cast<long double>(value) - reference) / unit));
}

struct Between {
  double low;
  double high;
};

// Evenly spread numbers, and as many whose logarithm is, of both signs where the range has both.
std::vector<double> arguments(const Between& range) {
  Rng rng(1);
  std::vector<double> out;
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  for (int i = 0; i < kArguments; ++i) {
    out.push_back(rng.uniform(range.low, range.high));
    const double fine = std::exp2(rng.uniform(-60.0, 0.0)) * largest * (rng.next() % 2 == 0 ? 1.0 : -1.0);
    out.push_back(std::clamp(fine, range.low, range.high));
  }
  return out;
}

// Numbers that differ by a few units of the last place from the multiples of a step.
std::vector<double> near_multiples(double step, int count) {
  std::vector<double> out;
  for (int i = -count; i <= count; ++i) {
    double x = step * i;
    for (int k = 0; k < 3; ++k) {
      out.push_back(x);
      out.push_back(-x);
      x = std::nextafter(x, kInfinity);
    }
  }
  return out;
}

template <class Own, class Reference>
double worst_ulp(const std::vector<double>& arguments, Own&& own, Reference&& reference) {
  double worst = 0.0;
  for (const double x : arguments) {
    const double error = error_ulp(own(x), reference(static_cast<long double>(x)));
    worst = error > worst || std::isnan(error) ? error : worst;
  }
  return worst;
}

template <class Own>
void expect_nan(Own&& own, std::initializer_list<double> arguments) {
  for (const double x : arguments) {
    EXPECT_TRUE(std::isnan(own(x))) << x;
  }
}

// Equal with its sign, also that of zero.
void expect_same(double value, double expected) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(value), std::bit_cast<std::uint64_t>(expected)) << value << " " << expected;
}

#define WORST_ULP(function, ...) \
  worst_ulp(                     \
      __VA_ARGS__, [](double x) { return math::function(x); }, [](long double x) { return std::function(x); })

TEST(Elementary, SineAndCosineAreWithinTheirErrorUpTo4000Turns) {
  for (const Between& range : {Between{-0.8, 0.8}, Between{-7.0, 7.0}, Between{-25000.0, 25000.0}}) {
    const std::vector<double> some = arguments(range);
    EXPECT_LE(WORST_ULP(sin, some), 0.9);
    EXPECT_LE(WORST_ULP(cos, some), 0.9);
    EXPECT_LE(WORST_ULP(tan, some), 2.5);
  }
  const std::vector<double> zeros = near_multiples(std::numbers::pi / 4.0, 30000);
  EXPECT_LE(WORST_ULP(sin, zeros), 0.9);
  EXPECT_LE(WORST_ULP(cos, zeros), 0.9);
  EXPECT_LE(WORST_ULP(tan, zeros), 2.5);
}

TEST(Elementary, SineAndCosineTogetherAreThoseAlone) {
  for (const double x : arguments({-30.0, 30.0})) {
    const auto [sin, cos] = math::sincos(x);
    ASSERT_EQ(sin, math::sin(x)) << x;
    ASSERT_EQ(cos, math::cos(x)) << x;
  }
}

TEST(Elementary, SineAndCosineOfSpecialNumbers) {
  expect_same(math::sin(0.0), 0.0);
  expect_same(math::sin(-0.0), -0.0);
  expect_same(math::sin(5e-324), 5e-324);
  expect_same(math::cos(-0.0), 1.0);
  expect_same(math::tan(-0.0), -0.0);
  expect_nan(math::sin, {kInfinity, -kInfinity, kNan});
  expect_nan(math::cos, {kInfinity, -kInfinity, kNan});
  for (const double x : {26000.0, 1e9, -1e300, std::numeric_limits<double>::max()}) {
    EXPECT_LE(error_ulp(math::sin(x), std::sin(std::remainder(x, 2.0 * std::numbers::pi) * 1.0L)), 0.9) << x;
    EXPECT_LE(error_ulp(math::cos(x), std::cos(std::remainder(x, 2.0 * std::numbers::pi) * 1.0L)), 0.9) << x;
  }
}

TEST(Elementary, ArctangentIsWithinItsErrorAllAround) {
  Rng rng(1);
  double worst = 0.0;
  for (int i = 0; i < kArguments; ++i) {
    const double any_y = std::exp2(rng.uniform(-40.0, 40.0)) * (rng.next() % 2 == 0 ? 1.0 : -1.0);
    const double y = i % 2 == 0 ? rng.uniform(-1.0, 1.0) : any_y;
    const double x = rng.uniform(-1.0, 1.0);
    worst = std::max(worst, error_ulp(math::atan2(y, x), std::atan2(static_cast<long double>(y), x)));
  }
  for (const double scale : {1e-270, 1e-300, 1e270, 1e300}) {
    for (const double slope : {-3.0, -0.7, 0.1, 0.24999, 0.25, 0.5, 0.72, 1.0, 7.0}) {
      const double error = error_ulp(math::atan2(slope * scale, scale), std::atan2(slope * scale * 1.0L, scale));
      worst = std::max(worst, error);
    }
  }
  EXPECT_LE(worst, 0.6);
  EXPECT_LE(WORST_ULP(atan, arguments({-2.0, 2.0})), 0.6);
  EXPECT_LE(WORST_ULP(atan, arguments({-1e6, 1e6})), 0.6);
  EXPECT_LE(WORST_ULP(asin, arguments({-1.0, 1.0})), 2.0);
}

TEST(Elementary, ArctangentOfSpecialNumbersIsTheLibrarys) {
  const std::vector<double> special{0.0, 1.0, 5e-324, std::numeric_limits<double>::max(), kInfinity};
  for (const double y : special) {
    for (const double x : special) {
      for (const double sy : {y, -y}) {
        for (const double sx : {x, -x}) {
          expect_same(math::atan2(sy, sx), static_cast<double>(std::atan2(static_cast<long double>(sy), sx)));
        }
      }
    }
    EXPECT_TRUE(std::isnan(math::atan2(y, kNan)) && std::isnan(math::atan2(kNan, y)));
  }
  expect_nan(math::asin, {1.0000001, -2.0, kNan});
}

TEST(Elementary, ExponentialIsWithinItsError) {
  for (const Between& range : {Between{-1.0, 1.0}, Between{-30.0, 30.0}, Between{-708.0, 709.7}}) {
    EXPECT_LE(WORST_ULP(exp, arguments(range)), 0.6);
    EXPECT_LE(WORST_ULP(expm1, arguments(range)), 2.5);
  }
  EXPECT_LE(WORST_ULP(exp, near_multiples(std::numbers::ln2 / 256.0, 100'000)), 0.6);
  EXPECT_LE(WORST_ULP(expm1, near_multiples(std::numbers::ln2 / 256.0, 1000)), 2.5);
  EXPECT_LE(WORST_ULP(exp, arguments({-745.0, -708.0})), 1.0);
}

TEST(Elementary, ExponentialOfSpecialNumbers) {
  expect_same(math::exp(-0.0), 1.0);
  expect_same(math::exp(kInfinity), kInfinity);
  expect_same(math::exp(710.0), kInfinity);
  expect_same(math::exp(-kInfinity), 0.0);
  expect_same(math::exp(-1e300), 0.0);
  expect_same(math::expm1(-0.0), -0.0);
  expect_same(math::expm1(5e-324), 5e-324);
  expect_same(math::expm1(-kInfinity), -1.0);
  expect_same(math::expm1(kInfinity), kInfinity);
  expect_nan(math::exp, {kNan, -kNan});
  expect_nan(math::expm1, {kNan, -kNan});
}

TEST(Elementary, LogarithmIsWithinItsError) {
  for (const Between& range :
       {Between{1e-300, 1.0}, Between{0.6, 1.6}, Between{0.99, 1.01}, Between{1e-9, 1e9}, Between{1.0, 1e300}}) {
    EXPECT_LE(WORST_ULP(log, arguments(range)), 0.6);
  }
  EXPECT_LE(WORST_ULP(log, arguments({5e-324, 1e-308})), 0.6);
  std::vector<double> near_one = arguments({-0.01, 0.01});
  std::transform(near_one.begin(), near_one.end(), near_one.begin(), [](double off) { return 1.0 + off; });
  EXPECT_LE(WORST_ULP(log, near_one), 0.6);
  for (const Between& range : {Between{-0.999, 1.0}, Between{0.0, 1.0}, Between{-1e-3, 1e-3}, Between{0.0, 1e30}}) {
    EXPECT_LE(WORST_ULP(log1p, arguments(range)), 1.5);
  }
}

TEST(Elementary, LogarithmOfSpecialNumbers) {
  expect_same(math::log(1.0), 0.0);
  expect_same(math::log(0.0), -kInfinity);
  expect_same(math::log(-0.0), -kInfinity);
  expect_same(math::log(kInfinity), kInfinity);
  expect_nan(math::log, {-1.0, -5e-324, -kInfinity, kNan});
  expect_same(math::log1p(-0.0), -0.0);
  expect_same(math::log1p(-1.0), -kInfinity);
  expect_same(math::log1p(kInfinity), kInfinity);
  expect_nan(math::log1p, {-1.5, kNan});
}

TEST(Elementary, ErrorFunctionAndHypotenuseAreWithinTheirErrors) {
  EXPECT_LE(WORST_ULP(erf, arguments({-1.0, 1.0})), 2.0);
  EXPECT_LE(WORST_ULP(erf, arguments({-7.0, 7.0})), 2.0);
  expect_same(math::erf(-0.0), -0.0);
  expect_same(math::erf(-kInfinity), -1.0);
  expect_nan(math::erf, {kNan});
  double worst = 0.0;
  const std::vector<double> sides = arguments({-1e6, 1e6});
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const auto reference = std::hypot(static_cast<long double>(sides[i]), static_cast<long double>(sides[i - 1]));
    worst = std::max(worst, error_ulp(math::hypot(sides[i], sides[i - 1]), reference));
  }
  EXPECT_LE(worst, 1.5);
}

// FNV-1a over the bits of a million values: what this number is says nothing but that every compiler, level of
// optimisation and processor on which this test passes computes the same.
TEST(Elementary, AMillionValuesHaveTheSameBitsEverywhere) {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto add = [&hash](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 64; shift += 8) {
      hash = (hash ^ ((bits >> shift) & 0xFFU)) * 1099511628211ULL;
    }
  };
  Rng rng(1);
  for (int i = 0; i < 100'000; ++i) {
    const double x = rng.uniform(-40.0, 40.0);
    const double unit = rng.uniform(-1.0, 1.0);
    const auto [sin, cos] = math::sincos(x);
    for (const double value : {sin, cos, math::tan(unit), math::atan2(x, unit), math::asin(unit), math::exp(x),
                               math::expm1(unit), math::log(x * x), math::log1p(unit), math::erf(4.0 * unit)}) {
      add(value);
    }
  }
  EXPECT_EQ(hash, 16584435796414342392ULL);
}

}  // namespace
}  // namespace odoless
