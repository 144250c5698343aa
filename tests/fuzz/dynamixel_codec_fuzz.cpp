// Dynamixel Protocol 2.0: bytes to packets, and packets to bytes and back. The input: what is done with it, how it is
// cut, and pieces; those that are to be mended become packets with stuffing and the right CRC.
#include <vector>

#include "drivers/tilt/dynamixel/packet.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace dynamixel = odoless::dynamixel;

constexpr std::size_t kParametersMax = 64;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 32U;
  std::vector<std::byte> bytes;
  std::size_t mended = 0;
  bool is_clean = true;
  while (!input.empty()) {
    const bool mends = (head & 1U) != 0 && input.byte() % 4U != 0;
    const auto piece = mends ? input.take(std::min<std::size_t>(input.byte(), kParametersMax)) : input.piece();
    if (mends) {
      const auto packet = dynamixel::encode(head / 2U, dynamixel::Instruction::kStatus, piece);
      const auto raw = std::as_bytes(packet.span());
      bytes.insert(bytes.end(), raw.begin(), raw.end());
      ++mended;
    } else {
      is_clean = is_clean && piece.empty();
      const auto raw = std::as_bytes(piece);
      bytes.insert(bytes.end(), raw.begin(), raw.end());
    }
  }
  odoless::test::check_any_split(std::span<const std::byte>(bytes), step, [&](auto all, std::size_t at_once) {
    dynamixel::PacketReader reader;
    Digest found;
    std::size_t packets = 0;
    odoless::test::feed(all, at_once, [&](std::span<const std::byte>& piece) {
      const auto outcome = reader.take(piece);
      if (outcome == dynamixel::PacketReader::Outcome::kPacket) {
        ++packets;
        ODOLESS_CHECK(reader.packet().size <= dynamixel::kPacketMaxBytes);
        found.add(std::as_bytes(reader.raw()));
        found.add(std::as_bytes(std::span(reader.packet().parameters).first(reader.packet().size)));
      }
      return outcome != dynamixel::PacketReader::Outcome::kMore;
    });
    ODOLESS_CHECK(!is_clean || packets == mended);  // what is encoded is read again
    return found;
  });
  return 0;
}
