#include "tools/emulate/rplidar_packets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace odoless {
namespace {

constexpr unsigned kEighthsMax = 63;
constexpr std::size_t kHeadBytesOfUltraDense = 6;  ///< clock and state, which are left 0
constexpr int kQuality = 15;

char byte(unsigned value) { return static_cast<char>(value & 0xFFU); }
void put(std::string& text, unsigned value) {
  text += byte(value);
  text += byte(value >> 8U);
}

int mm(double range_m) { return static_cast<int>(std::lround(range_m * 1000.0)); }
unsigned quarter_mm(double range_m) { return static_cast<unsigned>(std::lround(range_m * 4000.0)); }
unsigned eighths(double angle_deg) {
  return std::min(static_cast<unsigned>(std::lround(std::max(angle_deg, 0.0) * 8.0)), kEighthsMax);
}
unsigned q6(double angle_deg) { return static_cast<unsigned>(std::lround((angle_deg + 360.0) * 64.0)) % (360U * 64U); }

void put_express(std::string& bytes, std::span<const RplidarSample> samples) {
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    const unsigned first = eighths(samples[i].compensation_deg);
    const unsigned second = eighths(samples[i + 1].compensation_deg);
    put(bytes, (quarter_mm(samples[i].range_m) & 0xFFFCU) | (first >> 4U));
    put(bytes, (quarter_mm(samples[i + 1].range_m) & 0xFFFCU) | (second >> 4U));
    bytes += byte((first & 0x0FU) | ((second & 0x0FU) << 4U));
  }
}

/// The greatest that isn't beyond the range.
unsigned ultra_scaled(double range_m) {
  unsigned low = 0;
  for (unsigned high = 0x1000; high - low > 1;) {
    const unsigned middle = (low + high) / 2;
    (rplidar::ultra_range(middle).range_mm <= mm(range_m) ? low : high) = middle;
  }
  return low;
}

/// Where it is too large, the range isn't told.
unsigned ultra_difference(double range_m, unsigned scaled_base) {
  const rplidar::ScaledRange base = rplidar::ultra_range(scaled_base);
  const auto steps =
      static_cast<int>(std::lround((mm(range_m) - base.range_mm) / static_cast<double>(1 << base.level)));
  const bool is_told = range_m > 0.0 && std::abs(steps) < rplidar::kUltraNoDifference;
  return static_cast<unsigned>(is_told ? steps : rplidar::kUltraNoDifference) & 0x3FFU;
}

/// `samples`: one more than are told.
void put_ultra(std::string& bytes, std::span<const RplidarSample> samples) {
  for (std::size_t i = 0; i + 3 < samples.size(); i += 3) {
    const unsigned first = ultra_scaled(samples[i].range_m);
    const unsigned next = ultra_scaled(samples[i + 3].range_m);
    const unsigned second = ultra_difference(samples[i + 1].range_m, first != 0 ? first : next);
    const unsigned third = ultra_difference(samples[i + 2].range_m, next);
    const unsigned word = first | (second << 12U) | (third << 22U);
    put(bytes, word);
    put(bytes, word >> 16U);
  }
}

unsigned ultra_dense_word(double range_m) {
  unsigned which = 0;
  while (which + 1 < rplidar::kUltraDenseScales.size() &&
         mm(range_m) >= rplidar::kUltraDenseScales[which + 1].from_mm) {
    ++which;
  }
  const rplidar::UltraDenseScale& scale = rplidar::kUltraDenseScales[which];
  const auto steps = static_cast<unsigned>((mm(range_m) - scale.from_mm + scale.step_mm / 2) / scale.step_mm);
  const unsigned told = std::min(steps, (1U << scale.bits) - 1U);
  return (static_cast<unsigned>(range_m > 0.0 ? kQuality : 0) << (2U + scale.bits)) | (told << 2U) | which;
}

void put_ultra_dense(std::string& bytes, std::span<const RplidarSample> samples) {
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    const unsigned first = ultra_dense_word(samples[i].range_m);
    const unsigned second = ultra_dense_word(samples[i + 1].range_m);
    put(bytes, first);
    put(bytes, second);
    bytes += byte(((first >> 16U) & 0x0FU) | ((second >> 16U) << 4U));
  }
}

}  // namespace

double rplidar_express_compensation_deg(double compensation_deg) { return eighths(compensation_deg) / 8.0; }

std::string rplidar_nodes(std::span<const RplidarSample> samples) {
  std::string bytes;
  for (const RplidarSample& sample : samples) {
    const unsigned distance = quarter_mm(sample.range_m);
    const unsigned quality = distance == 0 ? 0 : kQuality;
    bytes += byte((quality << 2U) | (sample.starts_turn ? 1U : 2U));
    put(bytes, (q6(sample.mirror_deg - sample.compensation_deg) << 1U) | 1U);
    put(bytes, distance);
  }
  return bytes;
}

std::string rplidar_capsule(const rplidar::CapsuleFormat& format, std::span<const RplidarSample> samples,
                            bool is_first) {
  const auto told = samples.first(static_cast<std::size_t>(format.points));
  std::string bytes(format.type == rplidar::kUltraDenseType ? kHeadBytesOfUltraDense : 0, '\0');
  put(bytes, q6(samples.front().mirror_deg) | (is_first ? 0x8000U : 0U));
  switch (format.type) {
    case rplidar::kExpressType:
      put_express(bytes, told);
      break;
    case rplidar::kUltraType:
      put_ultra(bytes, samples);
      break;
    case rplidar::kDenseType:
      for (const RplidarSample& sample : told) {
        put(bytes, static_cast<unsigned>(mm(sample.range_m)));
      }
      break;
    default:
      put_ultra_dense(bytes, told);
  }
  unsigned sum = 0;
  for (const char c : bytes) {
    sum ^= static_cast<unsigned char>(c);
  }
  const std::array<char, 2> head{byte(0xA0U | (sum & 0x0FU)), byte(0x50U | (sum >> 4U))};
  return std::string(head.data(), head.size()) + bytes;
}

}  // namespace odoless
