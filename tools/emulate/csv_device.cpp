#include "tools/emulate/csv_device.hpp"

#include <fmt/format.h>

#include <iterator>
#include <numbers>
#include <string>
#include <utility>

namespace odoless {
namespace {

constexpr int kBeams = 360;
constexpr double kStartRad = -0.75 * std::numbers::pi;
constexpr double kStepRad = 0.0131;
constexpr std::int64_t kBeamNs = CsvDevice::kTurnNs * 3 / 4 / kBeams;
constexpr double kRangeFarM = 15.0;

EmulatedLrfOptions at_once(EmulatedLrfOptions options) {
  options.starts_at_once = true;
  return options;
}

}  // namespace

CsvDevice::CsvDevice(EmulatedScans& source, EmulatedLrfOptions options, std::int64_t now_ns)
    : EmulatedLrf(source, at_once(std::move(options))), switched_on_ns_(now_ns), ranges_m_(kBeams) {
  for (int i = 0; i < kBeams; ++i) {
    beams_.push_back({kStartRad + i * kStepRad, i * kBeamNs});
  }
}

std::int64_t CsvDevice::due_ns(std::int64_t piece) const {
  return origin_ns() + source().start_ns(piece) + beams_.back().time_ns;
}

void CsvDevice::on_due(std::int64_t piece) {
  const std::int64_t first_beam_ns = origin_ns() + source().start_ns(piece);
  measure(piece, beams_, ranges_m_, due_ns(piece));
  const double stamp_s = static_cast<double>(first_beam_ns - switched_on_ns_ + 1'000'000'000) * 1e-9;
  std::string line = fmt::format("scan,{:.6f},{:.6f},{:.6f},{:.9f}", stamp_s, kStartRad, kStepRad,
                                 static_cast<double>(kBeamNs) * 1e-9);
  const std::size_t sent = fault(FaultKind::kBeams, due_ns(piece)) ? kBeams * 2 / 3 : kBeams;
  for (std::size_t i = 0; i < sent; ++i) {
    if (ranges_m_[i] < kRangeFarM) {
      fmt::format_to(std::back_inserter(line), ",{:.3f}", ranges_m_[i]);
    } else {
      line += ",inf";
    }
  }
  send_piece(line + '\n', SentScan{piece, first_beam_ns}, due_ns(piece));
}

}  // namespace odoless
