#include "drivers/lrf/rplidar/packet.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::byte kStart{0xA5};
constexpr std::byte kAnswer{0x5A};
constexpr unsigned kHasPayload = 0x80;
constexpr std::size_t kCabinsStart = 4;
constexpr std::size_t kCabinBytes = 5;

unsigned at(std::span<const std::byte> bytes, std::size_t i) { return std::to_integer<unsigned>(bytes[i]); }
unsigned pair_at(std::span<const std::byte> bytes, std::size_t i) { return at(bytes, i) | (at(bytes, i + 1) << 8U); }

unsigned xor_of(std::span<const std::byte> bytes) {
  std::byte sum{0};
  for (const std::byte byte : bytes) {
    sum ^= byte;
  }
  return std::to_integer<unsigned>(sum);
}

/// 6 bits without a sign, in eighths of a degree.
double compensation_deg(unsigned bits) { return bits / 8.0; }

double wrapped_deg(double angle_deg) {
  const double wrapped_deg = angle_deg - 360.0 * std::floor(angle_deg / 360.0);
  return wrapped_deg < 360.0 ? wrapped_deg : 0.0;  // a tiny angle below 0 is rounded to 360
}

}  // namespace

Request::Request(Command command, std::span<const std::byte> payload) {
  ODOLESS_CHECK(payload.size() + 4 <= bytes_.size());
  bytes_[0] = kStart;
  bytes_[1] = static_cast<std::byte>(command);
  size_ = 2;
  if (payload.empty()) {
    return;
  }
  ODOLESS_CHECK((static_cast<unsigned>(command) & kHasPayload) != 0);
  bytes_[size_++] = static_cast<std::byte>(payload.size());
  std::copy(payload.begin(), payload.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += payload.size();
  const unsigned sum = xor_of({bytes_.data(), size_});
  bytes_[size_++] = static_cast<std::byte>(sum);
}

std::optional<Descriptor> descriptor_of(std::span<const std::byte> bytes) {
  if (bytes.size() < kDescriptorBytes || bytes[0] != kStart || bytes[1] != kAnswer) {
    return {};
  }
  const unsigned word = pair_at(bytes, 2) | (pair_at(bytes, 4) << 16U);
  return Descriptor{
      .length_bytes = word & 0x3FFFFFFFU, .is_stream = (word >> 30U) == 1U, .type = static_cast<int>(at(bytes, 6))};
}

std::optional<Point> node_of(std::span<const std::byte> bytes) {
  const bool starts = (at(bytes, 0) & 1U) != 0;
  const bool starts_not = (at(bytes, 0) & 2U) != 0;
  const double angle_deg = (pair_at(bytes, 1) >> 1U) / 64.0;
  if (starts == starts_not || (at(bytes, 1) & 1U) == 0 || angle_deg >= 360.0) {
    return {};
  }
  return Point{.angle_deg = angle_deg, .range_m = pair_at(bytes, 3) / 4000.0, .starts_turn = starts};
}

bool is_capsule(std::span<const std::byte> bytes) {
  const unsigned sum = (at(bytes, 0) & 0x0FU) | ((at(bytes, 1) & 0x0FU) << 4U);
  return (at(bytes, 0) >> 4U) == 0xAU && (at(bytes, 1) >> 4U) == 0x5U &&
         sum == xor_of(bytes.subspan(2, kCapsuleBytes - 2)) && capsule_angle_deg(bytes) < 360.0;
}

bool is_first_capsule(std::span<const std::byte> capsule) { return (pair_at(capsule, 2) & 0x8000U) != 0; }

double capsule_angle_deg(std::span<const std::byte> capsule) { return (pair_at(capsule, 2) & 0x7FFFU) / 64.0; }

std::array<Point, kCapsulePoints> points_of(std::span<const std::byte> capsule, double sweep_deg) {
  std::array<Point, kCapsulePoints> points;
  const double start_deg = capsule_angle_deg(capsule);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t cabin = kCabinsStart + i / 2 * kCabinBytes;
    const unsigned distance = pair_at(capsule, cabin + 2 * (i % 2));
    const unsigned low_bits = (at(capsule, cabin + 4) >> (4 * (i % 2))) & 0x0FU;
    const double angle_deg = start_deg + sweep_deg * static_cast<double>(i) / kCapsulePoints -
                             compensation_deg(low_bits | ((distance & 3U) << 4U));
    points[i] = {.angle_deg = wrapped_deg(angle_deg), .range_m = (distance & 0xFFFCU) / 4000.0, .starts_turn = false};
  }
  return points;
}

}  // namespace odoless::rplidar
