#include "core/math/elementary.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "core/math/double_double.hpp"

// Argument reduction by constants in parts [cody1980software; method 11], tables whose entries are known better than a
// double [tang1989exp, tang1990log; method 11], and polynomials of Chebyshev's nodes between. What is lost in the sum
// of a large and a small part stays with the small one.
namespace odoless::math {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kToWhole =
    0x1.8p52;  // x + kToWhole - kToWhole is x, rounded; the lowest bits of x + kToWhole are it, too
constexpr DoubleDouble kPi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
constexpr int kSteps = 128;  // of a table, per power of two

// c[0] + c[1] x + ...: by Horner's scheme, its even and its odd powers beside each other.
template <std::size_t kSize>
constexpr double polynomial(const std::array<double, kSize>& c, double x) {
  static_assert(kSize % 2 == 0);
  const double x2 = x * x;
  double even = c[kSize - 2];
  double odd = c[kSize - 1];
  for (std::size_t i = kSize - 2; i > 0; i -= 2) {
    even = even * x2 + c[i - 2];
    odd = odd * x2 + c[i - 1];
  }
  return even + odd * x;
}

// ---- sin, cos ----

// x_rad = quadrant * pi / 2 + high + low, |high| <= pi / 4.
struct Reduced {
  double high;
  double low;
  std::int64_t quadrant;
};

Reduced reduced(double x_rad) {
  constexpr double kReduced_max = 25000.0;  // whole parts below 2^14, of which the first two products are exact
  constexpr std::array<double, 3> kHalfPi{0x1.921fb54440000p+0, 0x1.68c234c4c0000p-39, 0x1.98a2e03707345p-77};
  const double x = std::abs(x_rad) <= kReduced_max ? x_rad : std::remainder(x_rad, 2.0 * kPi.high);
  const double shifted = x * 0x1.45f306dc9c883p-1 + kToWhole;
  const double whole = shifted - kToWhole;
  const double first = x - whole * kHalfPi[0];
  const double second = whole * kHalfPi[1];
  const double high = first - second;
  return {high, ((first - high) - second) - whole * kHalfPi[2], std::bit_cast<std::int64_t>(shifted)};
}

// (sin r - r) / r^3 as a polynomial of r^2, within 2^-55.
double sine(const Reduced& r) {
  constexpr std::array<double, 6> kSine{-0x1.5555555555555p-3, 0x1.1111111110bb2p-7,   -0x1.a01a019e83816p-13,
                                        0x1.71de379654304p-19, -0x1.ae600aca92c64p-26, 0x1.5e0b05bff20f2p-33};
  const double z = r.high * r.high;
  return r.high + (r.low * (1.0 - 0.5 * z) + r.high * z * polynomial(kSine, z));
}

// (cos r - 1 + r^2 / 2) / r^4 as a polynomial of r^2, within 2^-59.
double cosine(const Reduced& r) {
  constexpr std::array<double, 6> kCosine{0x1.5555555555555p-5,   -0x1.6c16c16c16967p-10, 0x1.a01a019f4e9b4p-16,
                                          -0x1.27e4fa17bf139p-22, 0x1.1eeb68cd22f56p-29,  -0x1.907d8f29fe831p-37};
  const double z = r.high * r.high;
  const double half = 0.5 * z;
  const double large = 1.0 - half;
  return large + (((1.0 - large) - half) + (z * z * polynomial(kCosine, z) - r.high * r.low));
}

// Below, sin x is x and cos x is 1.
constexpr double kTiny = 0x1p-27;

double with_sign(double value, std::int64_t negative) {
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(value) ^ (negative << 63));
}

// ---- exp ----

struct PowerOfTwo {
  double value;
  double relative_rest;  // what the value lacks, as a part of it
};

// 2^(i / 128) by Taylor's series.
constexpr std::array<PowerOfTwo, kSteps> kPowers = [] {
  std::array<PowerOfTwo, kSteps> out{};
  for (int i = 0; i < kSteps; ++i) {
    const DoubleDouble x = kLn2 * DoubleDouble{static_cast<double>(i) / kSteps};
    DoubleDouble power{1.0};
    for (int n = 30; n > 0; --n) {
      power = DoubleDouble{1.0} + power * x / static_cast<double>(n);
    }
    out[static_cast<std::size_t>(i)] = {power.high, power.low / power.high};
  }
  return out;
}();

// exp(x) = 2^exponent * table * (1 + rest)
struct SplitExp {
  double table;
  double rest;
  std::int64_t exponent;
};

// |x| < 800
SplitExp split_exp(double x) {
  constexpr DoubleDouble kStep{0x1.62e42fef80000p-8,
                               0x1.1cf79abc9e3b4p-43};  // ln(2) / 128; the first times 2^18: exact
  const double shifted = x * 0x1.71547652b82fep+7 + kToWhole;
  const double whole = shifted - kToWhole;
  const double r = (x - whole * kStep.high) - whole * kStep.low;
  const auto steps = static_cast<std::int32_t>(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(shifted)));
  const PowerOfTwo& power = kPowers[static_cast<std::uint32_t>(steps) % kSteps];
  const double r2 = r * r;
  const double more = r + r2 * ((0.5 + r * (1.0 / 6.0)) + r2 * (1.0 / 24.0 + r * (1.0 / 120.0)));
  return {power.value, power.relative_rest + more, steps >> 7};
}

double times_power(double value, std::int64_t exponent) {
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(value) + (exponent << 52));
}

constexpr double kPlain_max = 700.0;  // up to here exp is not infinite, and no part of its sum denormal

double exp_at_the_ends(double x) {
  if (!(x < 710.0)) {
    return x + kInfinity;  // NaN stays NaN
  }
  if (x < -746.0) {
    return 0.0;
  }
  const SplitExp split = split_exp(x);
  const std::int64_t half = split.exponent / 2;
  return times_power(1.0, half) * ((split.table + split.table * split.rest) * times_power(1.0, split.exponent - half));
}

// ---- log ----

struct LogStep {
  double inverse;   // 1 / c for a number c within the step, of 13 bits
  double log_high;  // log(c), a multiple of 2^-42
  double log_low;
};

// Where the steps begin: 1 is in the middle of one, and that step's c is 1, so that nothing cancels near it.
constexpr std::int64_t kFirstStep = std::bit_cast<std::int64_t>(1.0) - (151LL << 44);

// log c = -2 artanh((1 / c - 1) / (1 / c + 1)) by its series.
constexpr std::array<LogStep, kSteps> kLogSteps = [] {
  std::array<LogStep, kSteps> out{};
  for (int i = 0; i < kSteps; ++i) {
    const auto middle = std::bit_cast<double>(kFirstStep + ((2LL * i + 1) << 44));
    const double inverse = ((4096.0 / middle + kToWhole) - kToWhole) / 4096.0;
    const DoubleDouble t = DoubleDouble{1.0 - inverse} / (1.0 + inverse);
    const DoubleDouble t2 = t * t;
    DoubleDouble series{0.0};
    for (int n = 51; n > 0; n -= 2) {
      series = DoubleDouble{2.0} / static_cast<double>(n) + series * t2;
    }
    const DoubleDouble log = series * t;
    const double high = (log.high + 0x1.8p10) - 0x1.8p10;
    out[static_cast<std::size_t>(i)] = {inverse, high, (log.high - high) + log.low};
  }
  return out;
}();

// ---- atan2 ----

constexpr DoubleDouble negative(const DoubleDouble& a) { return {-a.high, -a.low}; }

// The angles whose tangents are 0, 1/2, 1, as they are seen in each half quadrant: [more steep than 45 deg][x < 0].
constexpr auto kAngles = [] {
  constexpr std::array<DoubleDouble, 3> kFlat{
      {{0.0, 0.0}, {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56}, {kPi.high / 4.0, kPi.low / 4.0}}};
  std::array<std::array<std::array<DoubleDouble, 3>, 2>, 2> out{};
  for (std::size_t i = 0; i < kFlat.size(); ++i) {
    const DoubleDouble steep = DoubleDouble{kPi.high / 2.0, kPi.low / 2.0} + negative(kFlat[i]);
    out[0][0][i] = kFlat[i];
    out[0][1][i] = kPi + negative(kFlat[i]);
    out[1][0][i] = steep;
    out[1][1][i] = kPi + negative(steep);
  }
  return out;
}();

double upper_bits(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & ~((std::uint64_t{1} << 27U) - 1U));
}

// numerator / (denominator.high + denominator.low), its high part of 26 bits.
DoubleDouble quotient(double numerator, const DoubleDouble& denominator) {
  const double inverse = 1.0 / denominator.high;
  const double high = upper_bits(numerator * inverse);
  const double upper = upper_bits(denominator.high);
  const double lower = (denominator.high - upper) + denominator.low;
  return {high, ((numerator - high * upper) - high * lower) * inverse};
}

// Both as they are, or what has the same quotient and can be computed with; large >= small >= 0.
DoubleDouble scaled(double large, double small) {
  if (large == 0.0) {
    return {1.0, 0.0};
  }
  if (large == kInfinity) {
    return {1.0, small == kInfinity ? 1.0 : 0.0};
  }
  const double factor = large > 0x1p900 ? 0x1p-200 : (large < 0x1p-900 ? 0x1p200 : 1.0);
  return {large * factor, small * factor};
}

// (atan r - r) / r^3 as a polynomial of r^2 <= 1/16, within 2^-62.
constexpr std::array<double, 10> kArctangent{
    -0x1.5555555555555p-2, 0x1.9999999999993p-3,  -0x1.24924924916d7p-3, 0x1.c71c71c5bc898p-4,  -0x1.745d16b676089p-4,
    0x1.3b138f9d303aap-4,  -0x1.110c40639605dp-4, 0x1.e106118ca9793p-5,  -0x1.a32dea59e68aep-5, 0x1.26f8d1bff5bc9p-5};

// erf(x) / x - 1 as a polynomial of x^2 <= 1, within 2^-56.
constexpr std::array<double, 12> kErfInner{0x1.06eba8214db68p-3,   -0x1.812746b0379c1p-2,  0x1.ce2f21a040f66p-4,
                                           -0x1.b82ce31203772p-6,  0x1.565bccfa44156p-8,   -0x1.c02db0665e53dp-11,
                                           0x1.f9a2be4f731a1p-14,  -0x1.f4ca838adb73bp-17, 0x1.b981d78881a5dp-20,
                                           -0x1.5c131500d3f88p-23, 0x1.d76af6ca49787p-27,  -0x1.ac9585a44fe29p-31};

// (1 - erf(x)) exp(x^2) as a polynomial of 3 / (3 + x) for 1 <= x <= 6, within 2^-57.
constexpr std::array<double, 16> kErfOuter{
    0x1.8bc9e4d99c45bp-22, 0x1.81212fc952070p-3,  0x1.818067e2e3a21p-3, 0x1.689df72224d24p-3,
    0x1.5471e990da206p-3,  0x1.5870c7fc90c87p-4,  0x1.e88342ae61032p-3, -0x1.4a474e7e2a7b8p-2,
    0x1.9014c93f13e04p-1,  -0x1.23f6e37d29cb6p+0, 0x1.498323ea793b2p+0, -0x1.0f10fddea340cp+0,
    0x1.1cc195bd7ade7p-1,  -0x1.535903ccbf2f0p-3, 0x1.6406cb7132f8bp-6, -0x1.d0badb83f2cadp-14};

}  // namespace

SinCos sincos(double x_rad) {
  if (std::abs(x_rad) < kTiny) {
    return {x_rad, 1.0};
  }
  const Reduced r = reduced(x_rad);
  const double s = sine(r);
  const double c = cosine(r);
  const std::int64_t odd = r.quadrant & 1;
  const std::int64_t lower = (r.quadrant >> 1) & 1;
  return {with_sign(odd != 0 ? c : s, lower), with_sign(odd != 0 ? s : c, lower ^ odd)};
}

double sin(double x_rad) {
  if (std::abs(x_rad) < kTiny) {
    return x_rad;
  }
  const Reduced r = reduced(x_rad);
  return with_sign((r.quadrant & 1) != 0 ? cosine(r) : sine(r), (r.quadrant >> 1) & 1);
}

double cos(double x_rad) {
  const Reduced r = reduced(x_rad);
  return with_sign((r.quadrant & 1) != 0 ? sine(r) : cosine(r), ((r.quadrant + 1) >> 1) & 1);
}

double tan(double x_rad) {
  const auto [s, c] = sincos(x_rad);
  return s / c;
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) {
    return kNan;
  }
  const bool is_steep = std::abs(y) > std::abs(x);
  const bool is_behind = std::signbit(x);
  const auto [large, small] = is_steep ? scaled(std::abs(y), std::abs(x)) : scaled(std::abs(x), std::abs(y));
  const int nearest = (small >= 0.25 * large ? 1 : 0) + (small >= 0.72 * large ? 1 : 0);  // tangent 0, 1/2 or 1
  const double tangent = 0.5 * nearest;
  const DoubleDouble r = quotient(small - tangent * large, fast_sum(large, tangent * small));
  const double value = r.high + r.low;
  const double z = value * value;
  const double rest = r.low + value * z * polynomial(kArctangent, z);
  const double sign = is_steep == is_behind ? 1.0 : -1.0;
  const DoubleDouble& from = kAngles[is_steep ? 1 : 0][is_behind ? 1 : 0][static_cast<std::size_t>(nearest)];
  const DoubleDouble sum = fast_sum(from.high, sign * r.high);
  return std::copysign(sum.high + (sum.low + (from.low + sign * rest)), y);
}

double atan(double x) { return atan2(x, 1.0); }

double asin(double x) { return atan2(x, std::sqrt((1.0 - x) * (1.0 + x))); }

double exp(double x) {
  if (!(std::abs(x) < kPlain_max)) {
    return exp_at_the_ends(x);
  }
  const SplitExp split = split_exp(x);
  const double power = times_power(split.table, split.exponent);
  return power + power * split.rest;
}

double expm1(double x) {
  if (std::abs(x) < 0x1p-54) {
    return x;
  }
  if (!(std::abs(x) < kPlain_max)) {
    return exp_at_the_ends(x) - 1.0;
  }
  const SplitExp split = split_exp(x);
  const double power = times_power(split.table, split.exponent);
  return (power - 1.0) + power * split.rest;
}

double log(double x) {
  if (!(x > 0.0 && x < kInfinity)) {
    return x == 0.0 ? -kInfinity : (x > 0.0 ? x : kNan);
  }
  constexpr DoubleDouble kParts{0x1.62e42fefa3800p-1, 0x1.ef35793c76730p-45};  // ln(2); the first a multiple of 2^-42
  const bool is_denormal = x < std::numeric_limits<double>::min();
  const auto bits = std::bit_cast<std::int64_t>(is_denormal ? x * 0x1p52 : x);
  const std::int64_t from_first = bits - kFirstStep;
  const std::int64_t exponent = from_first >> 52;
  const LogStep& step = kLogSteps[static_cast<std::size_t>(from_first >> 45) % kSteps];
  const auto z = std::bit_cast<double>(bits - (exponent << 52));
  const double upper = upper_bits(z);
  const DoubleDouble r = fast_sum(upper * step.inverse - 1.0, (z - upper) * step.inverse);  // both parts exact
  const double r2 = r.high * r.high;
  const double series =
      (-0.5 + r.high * (1.0 / 3.0)) + r2 * ((-0.25 + r.high * 0.2) + r2 * (-1.0 / 6.0 + r.high * (1.0 / 7.0)));
  const auto twos = static_cast<double>(exponent - (is_denormal ? 52 : 0));
  const DoubleDouble sum = fast_sum(twos * kParts.high + step.log_high, r.high);
  return sum.high + (sum.low + (r.low + (twos * kParts.low + step.log_low)) + r2 * series);
}

double log1p(double x) {
  const double sum = 1.0 + x;
  if (sum == 1.0) {
    return x;
  }
  if (!(sum > 0.0 && sum < kInfinity)) {
    return log(sum);
  }
  const double lost = x < 1.0 ? x - (sum - 1.0) : 1.0 - (sum - x);
  return log(sum) + lost / sum;
}

double erf(double x) {
  const double absolute = std::abs(x);
  if (absolute < 1.0) {
    return x + x * polynomial(kErfInner, x * x);
  }
  if (std::isnan(x)) {
    return x;
  }
  const double left = absolute < 6.0 ? exp(-absolute * absolute) * polynomial(kErfOuter, 3.0 / (3.0 + absolute)) : 0.0;
  return std::copysign(1.0 - left, x);
}

}  // namespace odoless::math
