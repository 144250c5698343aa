#include "drivers/lrf/rplidar/capsule.hpp"

#include <algorithm>
#include <numbers>

#include "drivers/lrf/rplidar/bytes.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::size_t kExpressCabinBytes = 5;     ///< of two samples: twice range and 2 bits, and twice 4 bits
constexpr std::size_t kUltraCabinBytes = 4;       ///< of three
constexpr std::size_t kDenseCabinBytes = 2;       ///< of one
constexpr std::size_t kUltraDenseCabinBytes = 5;  ///< of two: twice 16 bits, and twice the 4 bits above
constexpr double kAngleStepDeg = 1.0 / 64.0;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

// Of the geometry of lasers that triangulate: the distance of the receiver from the laser; nearer than that nothing is
// exact.
constexpr double kBaselineM = 0.024;
constexpr double kNearM = 0.05;
constexpr double kNearCompensationDeg = 7.5;

/// Of an angle that is less than a turn off.
double wrapped_deg(double angle_deg) {
  const double wrapped_deg = angle_deg < 0.0 ? angle_deg + 360.0 : angle_deg < 360.0 ? angle_deg : angle_deg - 360.0;
  return wrapped_deg < 360.0 ? wrapped_deg : 0.0;  // a tiny angle below 0 is rounded to 360
}

/// The lower `bits` of a word as a number with a sign.
int signed_bits(unsigned word, unsigned bits) {
  const int value = static_cast<int>(word & ((1U << bits) - 1U));
  return value >= 1 << (bits - 1) ? value - (1 << bits) : value;
}

double range_of_mm(int range_mm) { return std::max(range_mm, 0) / 1000.0; }

/// The compensation has 6 bits without a sign, in eighths of a degree.
Point express_point(std::span<const std::byte> cabins, std::size_t i) {
  const auto cabin = cabins.subspan(i / 2 * kExpressCabinBytes, kExpressCabinBytes);
  const unsigned distance = number_at(cabin, 2 * (i % 2));
  const unsigned low_bits = (byte_at(cabin, 4) >> (4 * (i % 2))) & 0x0FU;
  return {.angle_deg = -static_cast<double>(low_bits | ((distance & 3U) << 4U)) / 8.0,
          .range_m = (distance & 0xFFFCU) / 4000.0};
}

struct UltraCabin {
  ScaledRange first;
  std::array<int, 2> differences{};
};
UltraCabin ultra_cabin(std::span<const std::byte> cabins, std::size_t i) {
  const unsigned word = long_at(cabins, i * kUltraCabinBytes);
  return {.first = ultra_range(word & 0xFFFU),
          .differences = {signed_bits(word >> 12U, 10), signed_bits(word >> 22U, 10)}};
}

/// The second of three is told by its difference from the first (or, where that has no range, from the next cabin's
/// first), the third by its difference from the next cabin's first.
double ultra_range_m(const UltraCabin& cabin, const UltraCabin& next, std::size_t which) {
  if (which == 0) {
    return range_of_mm(cabin.first.range_mm);
  }
  const int difference = cabin.differences[which - 1];
  if (difference == kUltraNoDifference || difference == -kUltraNoDifference - 1) {
    return 0.0;
  }
  const ScaledRange& base = which == 2 || cabin.first.range_mm == 0 ? next.first : cabin.first;
  return range_of_mm(base.range_mm + difference * (1 << base.level));
}

Point ultra_point(std::span<const std::byte> cabins, std::span<const std::byte> next_cabins, std::size_t i) {
  const bool is_last = (i / 3 + 2) * kUltraCabinBytes > cabins.size();
  const UltraCabin next = is_last ? ultra_cabin(next_cabins, 0) : ultra_cabin(cabins, i / 3 + 1);
  const double range_m = ultra_range_m(ultra_cabin(cabins, i / 3), next, i % 3);
  return {.angle_deg = range_m > 0.0 ? -compensation_deg(range_m) : 0.0, .range_m = range_m};
}

double ultra_dense_range_m(std::span<const std::byte> cabins, std::size_t i) {
  const auto cabin = cabins.subspan(i / 2 * kUltraDenseCabinBytes, kUltraDenseCabinBytes);
  const unsigned word = number_at(cabin, 2 * (i % 2));  // the bits above it are quality alone
  const UltraDenseScale& scale = kUltraDenseScales[word & 3U];
  return range_of_mm(static_cast<int>((word >> 2U) & ((1U << scale.bits) - 1U)) * scale.step_mm + scale.from_mm);
}

/// A sample of a capsule, its angle from the mirror's.
Point sample_of(int type, std::span<const std::byte> cabins, std::span<const std::byte> next_cabins, std::size_t i) {
  switch (type) {
    case kExpressType:
      return express_point(cabins, i);
    case kUltraType:
      return ultra_point(cabins, next_cabins, i);
    case kDenseType:
      return {.angle_deg = 0.0, .range_m = number_at(cabins, i * kDenseCabinBytes) / 1000.0};
    default:
      return {.angle_deg = 0.0, .range_m = ultra_dense_range_m(cabins, i)};
  }
}

}  // namespace

const CapsuleFormat* find_capsule_format(int type) {
  const auto* const found = std::find_if(kCapsuleFormats.begin(), kCapsuleFormats.end(),
                                         [&](const CapsuleFormat& format) { return format.type == type; });
  return found == kCapsuleFormats.end() ? nullptr : found;
}

bool is_capsule(const CapsuleFormat& format, std::span<const std::byte> bytes) {
  const unsigned sum = (byte_at(bytes, 0) & 0x0FU) | ((byte_at(bytes, 1) & 0x0FU) << 4U);
  return is_marked(bytes) && sum == xor_of(bytes.subspan(2, format.bytes - 2)) &&
         capsule_angle_deg(format, bytes) < 360.0;
}

bool is_first_capsule(const CapsuleFormat& format, std::span<const std::byte> capsule) {
  return (number_at(capsule, format.angle_at) & 0x8000U) != 0;
}

double capsule_angle_deg(const CapsuleFormat& format, std::span<const std::byte> capsule) {
  return (number_at(capsule, format.angle_at) & 0x7FFFU) * kAngleStepDeg;
}

// The arc sine is its series: it is asked for once per sample.
double compensation_deg(double range_m) {
  if (range_m < kNearM) {
    return kNearCompensationDeg;
  }
  const double sine = kBaselineM / range_m;
  const double square = sine * sine;
  const double series =
      1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (5.0 / 112.0 + square * (35.0 / 1152.0))));
  return kCompensationMaxDeg - sine * series * kDegPerRad;
}

ScaledRange ultra_range(unsigned scaled) {
  struct Scale {
    unsigned from;
    int from_mm;
    int level;
  };
  constexpr std::array<Scale, 5> kScales{
      {{3328, 16384, 4}, {1792, 4096, 3}, {1280, 2048, 2}, {512, 512, 1}, {0, 0, 0}}};
  const auto* const scale =
      std::find_if(kScales.begin(), kScales.end() - 1, [&](const Scale& one) { return scaled >= one.from; });
  return {.range_mm = scale->from_mm + (static_cast<int>(scaled - scale->from) << scale->level), .level = scale->level};
}

void read_points(const CapsuleFormat& format, std::span<const std::byte> capsule, std::span<const std::byte> next,
                 double sweep_deg, std::span<Point, kCapsulePointsMax> points) {
  const double start_deg = capsule_angle_deg(format, capsule);
  const double step_deg = sweep_deg / format.points;
  const auto cabins = capsule.subspan(format.angle_at + 2);
  const auto next_cabins = next.subspan(format.angle_at + 2);
  for (std::size_t i = 0; i < static_cast<std::size_t>(format.points); ++i) {
    points[i] = sample_of(format.type, cabins, next_cabins, i);
    points[i].angle_deg = wrapped_deg(start_deg + step_deg * static_cast<double>(i) + points[i].angle_deg);
  }
}

}  // namespace odoless::rplidar
