// Lines of text: bytes to lines, and lines to scans. The input: how it is cut, and bytes.
#include <array>
#include <cmath>

#include "drivers/lrf/csv/scan_line.hpp"
#include "tests/fuzz/codec_fuzz.hpp"

namespace {

using odoless::test::Digest;
namespace csv = odoless::csv;

constexpr std::size_t kLineMaxBytes = 256;
constexpr std::size_t kBeamsMax = 32;

void read(std::string_view line, Digest& found) {
  std::array<float, kBeamsMax> ranges_m{};
  const auto scan = csv::scan_line_of(line, ranges_m);
  found.add_number(static_cast<int>(scan.error()));
  if (!scan.ok()) {
    return;
  }
  const csv::ScanShape& shape = scan.value().shape;
  ODOLESS_CHECK(shape.beams >= 2 && static_cast<std::size_t>(shape.beams) <= kBeamsMax);
  ODOLESS_CHECK(std::isfinite(shape.start_angle_rad) && std::isfinite(shape.angle_step_rad) &&
                shape.angle_step_rad != 0.0 && std::isfinite(shape.beam_period_s) && shape.beam_period_s >= 0.0);
  ODOLESS_CHECK(!scan.value().stamp_s || (*scan.value().stamp_s >= 0.0 && std::isfinite(*scan.value().stamp_s)));
  for (int i = 0; i < shape.beams; ++i) {
    ODOLESS_CHECK(ranges_m[static_cast<std::size_t>(i)] >= 0.0F);
    found.add_number(ranges_m[static_cast<std::size_t>(i)]);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  const std::size_t step = 1U + input.byte() % 96U;
  const auto all = std::as_bytes(input.take(size));
  odoless::test::check_any_split(all, step, [](auto bytes, std::size_t at_once) {
    csv::LineReader reader(kLineMaxBytes);
    Digest found;
    odoless::test::feed(bytes, at_once, [&](std::span<const std::byte>& piece) {
      const auto outcome = reader.take(piece);
      if (outcome == csv::LineReader::Outcome::kLine) {
        read(reader.line(), found);
      } else if (outcome == csv::LineReader::Outcome::kSkipped) {
        found.add_number(-1);
      }
      return outcome != csv::LineReader::Outcome::kMore;
    });
    return found;
  });
  return 0;
}
