// SCIP: bytes to replies, and replies to status, parameters and scans. The input: what is done with it, how it is cut,
// and lines; those that are to be mended get their check sum, so that what is behind the sums is reached.
#include <array>
#include <string>
#include <utility>

#include "drivers/lrf/scip/number.hpp"
#include "drivers/lrf/scip/replies.hpp"
#include "drivers/lrf/scip/reply_reader.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace scip = odoless::scip;

constexpr std::string_view kEcho = "MD0044002001000";
constexpr int kBeams = 24;
constexpr std::uint32_t kValueEnd = 1U << 18U;

void look(const scip::Reply& reply, Digest& found) {
  for (int i = 0; i < reply.lines(); ++i) {
    found.add(reply.line(i));
  }
  found.add_number(scip::is_scip1(reply));
  if (const auto status = scip::status_of(reply); status.ok()) {
    found.add_number(status.value());
  }
  if (const auto parameters = scip::parameters_of(reply); parameters.ok()) {
    const scip::Parameters& p = parameters.value();
    ODOLESS_CHECK(p.last_step > p.first_step && p.turns_per_minute > 0 && p.steps_per_turn > 0);
    ODOLESS_CHECK(p.range_min_mm >= 0 && p.range_max_mm > p.range_min_mm);
  }
  std::array<std::uint32_t, kBeams> ranges_mm{};
  std::array<char, 512> data{};
  for (const auto& [values, choice] : {std::pair(1U, scip::EchoChoice::kOnly),
                                       {2U, scip::EchoChoice::kOnly},
                                       {1U, scip::EchoChoice::kLast},
                                       {2U, scip::EchoChoice::kStrongest}}) {
    const scip::ScanFormat format{
        .echo = kEcho, .characters_per_value = 3, .values_per_beam = values, .beams = kBeams, .choice = choice};
    const auto scan = scip::scan_of(reply, format, {data, ranges_mm});
    if (scan.ok()) {
      ODOLESS_CHECK(scan.value().ranges_mm.size() == kBeams);
      for (const std::uint32_t range_mm : scan.value().ranges_mm) {
        ODOLESS_CHECK(range_mm < kValueEnd);
        found.add_number(range_mm);
      }
    }
  }
}

std::string lines_of(odoless::test::FuzzInput& input, bool mends) {
  std::string bytes;
  while (!input.empty()) {
    const auto piece = input.piece();
    std::string line(piece.begin(), piece.end());
    if (mends && !line.empty()) {
      line += scip::checksum(line);
    }
    bytes += line + '\n';
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 32U;
  std::string bytes = (head & 2U) != 0 ? std::string(kEcho) + '\n' : std::string();
  if ((head & 4U) != 0) {
    bytes += lines_of(input, (head & 8U) != 0);
  } else {
    const auto rest = input.take(size);
    bytes.append(rest.begin(), rest.end());
  }
  // What is too long for the memory is dropped, and what is left of its last line depends on the pieces.
  const std::size_t room = (head & 16U) != 0 ? 64 : bytes.size() + 1;
  const auto read = [&](std::string_view all, std::size_t at_once) {
    scip::ReplyReader reader(room, 24);
    reader.expect_stream((head & 1U) != 0 ? kEcho : std::string_view());
    Digest found;
    odoless::test::feed(all, at_once, [&](std::string_view& piece) {
      const auto outcome = reader.take(piece);
      if (outcome == scip::ReplyReader::Outcome::kReply) {
        look(reader.reply(), found);
      }
      return outcome != scip::ReplyReader::Outcome::kMore;
    });
    return found;
  };
  if (room > bytes.size()) {
    odoless::test::check_any_split(std::string_view(bytes), step, read);
  } else {
    static_cast<void>(read(bytes, step));
  }
  return 0;
}
