// SOPAS: bytes to telegrams, and telegrams to scans. The input: what is done with it, how it is cut, and bytes; those
// that are to be mended become one telegram of a scan, in ASCII or with its length and sum.
#include <cmath>
#include <string>
#include <vector>

#include "drivers/lrf/sopas/scan_stream.hpp"
#include "drivers/lrf/sopas/telegram.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace sopas = odoless::sopas;
using Outcome = sopas::TelegramReader::Outcome;

constexpr std::size_t kContentMaxBytes = 4096;
constexpr int kBeamsMax = 64;

std::string mended(std::string_view rest, bool is_binary) {
  const std::string content = "sSN LMDscandata " + std::string(rest);
  if (!is_binary) {
    return '\x02' + content + '\x03';
  }
  std::string head(8, '\x02');
  char sum = 0;
  for (std::size_t byte = 0; byte < 4; ++byte) {
    head[4 + byte] = static_cast<char>(content.size() >> (8 * (3 - byte)));
  }
  for (const char c : content) {
    sum = static_cast<char>(sum ^ c);
  }
  return head + content + sum;
}

void check_telegrams(std::span<const std::byte> bytes, std::size_t step) {
  odoless::test::check_any_split(bytes, step, [](auto all, std::size_t at_once) {
    sopas::TelegramReader reader(kContentMaxBytes);
    Digest found;
    odoless::test::feed(all, at_once, [&](std::span<const std::byte>& piece) {
      const Outcome outcome = reader.take(piece);
      if (outcome != Outcome::kMore) {
        found.add_number(static_cast<int>(outcome));
      }
      if (outcome == Outcome::kTelegram) {
        found.add(reader.telegram().content);
        found.add(reader.telegram().name());
        found.add_number(reader.telegram().refusal_code());
      }
      return outcome != Outcome::kMore;
    });
    return found;
  });
}

void check_scans(std::span<const std::byte> bytes) {
  static sopas::ScanStream stream(odoless::LrfParams{}, kBeamsMax);  // made once
  sopas::TelegramReader reader(kContentMaxBytes);
  std::int64_t now_ns = 1'000'000'000;
  for (Outcome outcome = reader.take(bytes); outcome != Outcome::kMore; outcome = reader.take(bytes)) {
    const auto data = outcome == Outcome::kTelegram ? stream.read(reader.telegram())
                                                    : odoless::Result<sopas::ScanData>(odoless::Errc::kFrameMalformed);
    if (!data.ok() || stream.configure(data.value()) != odoless::Errc::kOk) {
      continue;
    }
    const auto scan = stream.scan(data.value(), now_ns += 100'000'000);
    if (scan.ok()) {
      ODOLESS_CHECK(static_cast<int>(scan.value().ranges_m.size()) == stream.geometry().beams);
      ODOLESS_CHECK(std::isfinite(scan.value().start_angle_rad) && scan.value().angle_step_rad > 0.0);
      for (const float range_m : scan.value().ranges_m) {
        ODOLESS_CHECK(range_m >= 0.0F);
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::uint8_t head = input.byte();
  const std::size_t step = 1U + input.byte() % 96U;
  const auto rest = input.take(size);
  std::string bytes(reinterpret_cast<const char*>(rest.data()), rest.size());
  if ((head & 1U) != 0) {
    bytes = mended(bytes, (head & 2U) != 0);
  }
  const auto all = std::as_bytes(std::span<const char>(bytes));
  check_telegrams(all, step);
  check_scans(all);
  return 0;
}
