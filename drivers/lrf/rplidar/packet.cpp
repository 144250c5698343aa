#include "drivers/lrf/rplidar/packet.hpp"

#include <algorithm>

#include "core/base/check.hpp"
#include "drivers/lrf/rplidar/bytes.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::byte kStart{0xA5};
constexpr std::byte kAnswer{0x5A};
constexpr unsigned kHasPayload = 0x80;

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
  const unsigned word = long_at(bytes, 2);
  return Descriptor{.length_bytes = word & 0x3FFFFFFFU,
                    .is_stream = (word >> 30U) == 1U,
                    .type = static_cast<int>(byte_at(bytes, 6))};
}

std::optional<Point> node_of(std::span<const std::byte> bytes) {
  const bool starts = (byte_at(bytes, 0) & 1U) != 0;
  const bool starts_not = (byte_at(bytes, 0) & 2U) != 0;
  const double angle_deg = (number_at(bytes, 1) >> 1U) / 64.0;
  if (starts == starts_not || (byte_at(bytes, 1) & 1U) == 0 || angle_deg >= 360.0) {
    return {};
  }
  return Point{.angle_deg = angle_deg, .range_m = number_at(bytes, 3) / 4000.0, .starts_turn = starts};
}

}  // namespace odoless::rplidar
