// RPLIDAR: bytes to points, and points to turns. The input: what is done with it, how it is cut, and bytes; capsules
// that are to be mended get their marks and their sum, nodes their check bits.
#include <array>
#include <cmath>
#include <vector>

#include "drivers/lrf/rplidar/capsule.hpp"
#include "drivers/lrf/rplidar/packet.hpp"
#include "drivers/lrf/rplidar/point_reader.hpp"
#include "drivers/lrf/rplidar/turn.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace rplidar = odoless::rplidar;

void mend_capsule(std::span<std::uint8_t> capsule) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : capsule.subspan(2)) {
    sum ^= byte;
  }
  capsule[0] = static_cast<std::uint8_t>(0xA0U | (sum & 0x0FU));
  capsule[1] = static_cast<std::uint8_t>(0x50U | (sum >> 4U));
}

void mend_node(std::span<std::uint8_t> node) {
  const unsigned starts = node[0] & 1U;
  node[0] = static_cast<std::uint8_t>((node[0] & 0xFCU) | starts | ((starts ^ 1U) << 1U));
  node[1] |= 1U;
}

/// @param format  Null: nodes.
void mend(std::vector<std::uint8_t>& bytes, const rplidar::CapsuleFormat* format) {
  const std::size_t packet = format == nullptr ? rplidar::kNodeBytes : format->bytes;
  for (std::size_t at = 0; at + packet <= bytes.size(); at += packet) {
    const auto one = std::span(bytes).subspan(at, packet);
    format == nullptr ? mend_node(one) : mend_capsule(one);
  }
}

void take_points(const rplidar::PointReader& reader, rplidar::Turn& turn, Digest& found) {
  std::int64_t sample = reader.first_sample();
  for (const rplidar::Point& point : reader.points()) {
    ODOLESS_CHECK(point.angle_deg >= 0.0 && point.angle_deg < 360.0);
    ODOLESS_CHECK(point.range_m >= 0.0 && std::isfinite(point.range_m));
    found.add_number(point.angle_deg);
    found.add_number(point.range_m);
    found.add_number(point.starts_turn);
    if (turn.add(point, 500'000 * sample++)) {
      std::array<float, 90> ranges_m{};
      ODOLESS_CHECK(turn.resample(ranges_m) <= static_cast<int>(ranges_m.size()));
      for (const float range_m : ranges_m) {
        ODOLESS_CHECK(range_m >= 0.0F);
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static rplidar::Turn turn;  // large: made once
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 96U;
  const std::size_t kind = head % 8U;
  const rplidar::CapsuleFormat* const format =
      kind < rplidar::kCapsuleFormats.size() ? &rplidar::kCapsuleFormats[kind] : nullptr;
  const auto rest = input.take(size);
  std::vector<std::uint8_t> bytes(rest.begin(), rest.end());
  if ((head & 8U) != 0) {
    mend(bytes, format);
  }
  const auto all_bytes = std::as_bytes(std::span<const std::uint8_t>(bytes));
  static_cast<void>(rplidar::descriptor_of(all_bytes.first(std::min(all_bytes.size(), rplidar::kDescriptorBytes))));
  odoless::test::check_any_split(all_bytes, step, [&](auto all, std::size_t at_once) {
    rplidar::PointReader reader;
    reader.start(format);
    turn.clear();
    Digest found;
    odoless::test::feed(all, at_once, [&](std::span<const std::byte>& piece) {
      const auto outcome = reader.take(piece);
      if (outcome == rplidar::PointReader::Outcome::kPoints) {
        take_points(reader, turn, found);
      }
      return outcome != rplidar::PointReader::Outcome::kMore;
    });
    return found;
  });
  return 0;
}
