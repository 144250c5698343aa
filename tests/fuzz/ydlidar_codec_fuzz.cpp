// YDLIDAR: bytes to packets, and packets to turns. The input: what is done with it, how it is cut, and bytes; packets
// that are to be mended get their start, angles that can be, and their check word.
#include <vector>

#include "drivers/lrf/ydlidar/packet.hpp"
#include "drivers/lrf/ydlidar/scan_stream.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace ydlidar = odoless::ydlidar;

void mend(std::vector<std::uint8_t>& bytes) {
  for (std::size_t at = 0; at + ydlidar::kHeadBytes + ydlidar::kSampleBytes <= bytes.size();) {
    const std::size_t room = (bytes.size() - at - ydlidar::kHeadBytes) / ydlidar::kSampleBytes;
    const std::size_t count = std::min<std::size_t>(1U + bytes[at + 3] % 40U, room);
    const auto one = std::span(bytes).subspan(at, ydlidar::kHeadBytes + ydlidar::kSampleBytes * count);
    one[0] = 0xAA;
    one[1] = 0x55;
    one[3] = static_cast<std::uint8_t>(count);
    one[4] |= 1U;
    one[5] &= 0x7FU;
    one[6] = one[4];
    one[7] = static_cast<std::uint8_t>((one[5] + (count - 1) / 2U) & 0x7FU);
    const std::uint16_t sum = ydlidar::check_word(std::as_bytes(one));
    one[8] = static_cast<std::uint8_t>(sum);
    one[9] = static_cast<std::uint8_t>(sum >> 8U);
    at += one.size();
  }
}

void check_packets(std::span<const std::byte> bytes, std::size_t step) {
  odoless::test::check_any_split(bytes, step, [](auto all, std::size_t at_once) {
    ydlidar::PacketReader reader;
    Digest found;
    odoless::test::feed(all, at_once, [&](std::span<const std::byte>& piece) {
      const auto outcome = reader.take(piece);
      if (outcome != ydlidar::PacketReader::Outcome::kMore) {
        found.add_number(static_cast<int>(outcome));
      }
      if (outcome == ydlidar::PacketReader::Outcome::kPacket) {
        for (std::size_t i = 0; i < reader.packet().count; ++i) {
          const double angle_deg = reader.packet().angle_deg(i);
          ODOLESS_CHECK(angle_deg >= 0.0 && angle_deg < 360.0);
          found.add_number(angle_deg);
          found.add_number(reader.packet().samples[i]);
        }
      }
      return outcome != ydlidar::PacketReader::Outcome::kMore;
    });
    return found;
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 96U;
  const std::int64_t way_ns = 1'000'000 * (1 + input.byte() % 32);
  const auto rest = input.take(size);
  std::vector<std::uint8_t> bytes(rest.begin(), rest.end());
  if ((head & 1U) != 0) {
    mend(bytes);
  }
  const auto all = std::as_bytes(std::span<const std::uint8_t>(bytes));
  check_packets(all, step);
  static ydlidar::ScanStream stream(odoless::LrfParams{}, 450);  // large: made once
  ODOLESS_CHECK(stream.configure(128000) == odoless::Errc::kOk);
  std::int64_t now_ns = 1'000'000'000;
  odoless::test::feed(all, step, [&](std::span<const std::byte>& piece) {
    const odoless::FoundScan found = stream.take(piece, now_ns += way_ns);
    if (found.scan) {
      ODOLESS_CHECK(found.scan->ranges_m.size() == 450);
      for (const float range_m : found.scan->ranges_m) {
        ODOLESS_CHECK(range_m >= 0.0F);
      }
    }
    return found.scan || found.error != odoless::Errc::kOk;
  });
  return 0;
}
