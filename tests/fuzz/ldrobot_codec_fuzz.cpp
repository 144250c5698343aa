// LDROBOT: bytes to packets, and packets to turns. The input: what is done with it, how it is cut, and bytes; packets
// that are to be mended get their start and their sum.
#include <cmath>
#include <vector>

#include "drivers/lrf/ldrobot/packet.hpp"
#include "drivers/lrf/ldrobot/scan_stream.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace ldrobot = odoless::ldrobot;

void mend(std::vector<std::uint8_t>& bytes) {
  for (std::size_t at = 0; at + ldrobot::kPacketBytes <= bytes.size(); at += ldrobot::kPacketBytes) {
    const auto one = std::span(bytes).subspan(at, ldrobot::kPacketBytes);
    one[0] = 0x54;
    one[1] = 0x2C;
    one[3] &= 0x1FU;  // speed and angles that can be
    one[5] &= 0x7FU;
    one[42] = one[4];
    one[43] = static_cast<std::uint8_t>((one[5] + one[43] % 8U) & 0x7FU);
    one[45] &= 0x3FU;
    one.back() = ldrobot::checksum(std::as_bytes(one.first(one.size() - 1)));
  }
}

void check_packets(std::span<const std::byte> bytes, std::size_t step) {
  odoless::test::check_any_split(bytes, step, [](auto all, std::size_t at_once) {
    ldrobot::PacketReader reader;
    Digest found;
    odoless::test::feed(all, at_once, [&](std::span<const std::byte>& piece) {
      const auto outcome = reader.take(piece);
      if (outcome != ldrobot::PacketReader::Outcome::kMore) {
        found.add_number(static_cast<int>(outcome));
      }
      if (outcome == ldrobot::PacketReader::Outcome::kPacket) {
        for (std::size_t i = 0; i < ldrobot::kPacketPoints; ++i) {
          const double angle_deg = reader.packet().angle_deg(i);
          ODOLESS_CHECK(angle_deg >= 0.0 && angle_deg < 360.0);
          found.add_number(angle_deg);
          found.add_number(reader.packet().points[i].range_m);
        }
      }
      return outcome != ldrobot::PacketReader::Outcome::kMore;
    });
    return found;
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 96U;
  const auto rest = input.take(size);
  std::vector<std::uint8_t> bytes(rest.begin(), rest.end());
  if ((head & 1U) != 0) {
    mend(bytes);
  }
  const auto all = std::as_bytes(std::span<const std::uint8_t>(bytes));
  check_packets(all, step);
  static ldrobot::ScanStream stream(odoless::LrfParams{}, 450);  // large: made once
  ODOLESS_CHECK(stream.configure({}, 230400) == odoless::Errc::kOk);
  std::int64_t now_ns = 1'000'000'000;
  odoless::test::feed(all, step, [&](std::span<const std::byte>& piece) {
    const odoless::FoundScan found = stream.take(piece, now_ns += 1'000'000);
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
