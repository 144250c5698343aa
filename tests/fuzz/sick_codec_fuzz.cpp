// SICK: bytes to telegrams. The input: what is done with it, how it is cut, and pieces; those that are to be mended
// become telegrams with the right sum, so that what is behind the sums is reached.
#include <vector>

#include "drivers/lrf/sick/telegram.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace sick = odoless::sick;

constexpr std::size_t kPayloadMax = 64;

void add_telegram(std::vector<std::byte>& bytes, std::span<const std::uint8_t> payload) {
  const std::size_t start = bytes.size();
  const auto length = static_cast<unsigned>(payload.size());
  for (const unsigned value : {0x02U, 0x80U, length & 0xFFU, length >> 8U}) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  for (const std::uint8_t value : payload) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  const unsigned sum = sick::checksum(std::span(bytes).subspan(start));
  bytes.push_back(static_cast<std::byte>(sum & 0xFFU));
  bytes.push_back(static_cast<std::byte>(sum >> 8U));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 32U;
  const std::size_t stream_bytes = (head & 1U) != 0 ? 2U + head / 4U : 0U;
  std::vector<std::byte> bytes;
  while (!input.empty()) {
    const bool mends = (head & 2U) != 0 && input.byte() % 4U != 0;
    const auto piece = input.piece();
    if (mends) {
      add_telegram(bytes, piece);
    } else {
      const auto raw = std::as_bytes(piece);
      bytes.insert(bytes.end(), raw.begin(), raw.end());
    }
  }
  odoless::test::check_any_split(std::span<const std::byte>(bytes), step, [&](auto all, std::size_t at_once) {
    sick::TelegramReader reader(kPayloadMax);
    reader.expect_stream(stream_bytes);
    Digest found;
    odoless::test::feed(all, at_once, [&](std::span<const std::byte>& piece) {
      const auto outcome = reader.take(piece);
      if (outcome == sick::TelegramReader::Outcome::kTelegram) {
        const sick::Telegram& telegram = reader.telegram();
        ODOLESS_CHECK(telegram.payload.size() >= 2 && telegram.payload.size() <= kPayloadMax);
        ODOLESS_CHECK(telegram.data().size() + 2 == telegram.payload.size());
        found.add(telegram.payload);
      }
      return outcome != sick::TelegramReader::Outcome::kMore;
    });
    return found;
  });
  return 0;
}
