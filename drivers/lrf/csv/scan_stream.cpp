#include "drivers/lrf/csv/scan_stream.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/float_precision.hpp"

namespace odoless::csv {
namespace {

constexpr double kRangeMaxM = 100.0;  ///< nothing tells it
constexpr std::int64_t kPeriodMinNs = 2'000'000;
constexpr std::int64_t kPeriodMaxNs = 2'000'000'000;
constexpr std::uint32_t kCounterBits = 0xFFFFFF;

}  // namespace

ScanStream::ScanStream(const LrfParams& /*params*/, int beams_max)
    : ranges_m_(static_cast<std::size_t>(beams_max)), buffer_(beams_max) {}

void ScanStream::configure(const ScanLine& first, std::int64_t period_ns) {
  shape_ = first.shape;
  beam_period_ns_ = std::llround(shape_.beam_period_s * 1e9);
  sweep_ns_ = beam_period_ns_ * (shape_.beams - 1);
  geometry_ = {.beams = shape_.beams,
               .start_angle_rad = to_float_precision(shape_.start_angle_rad),
               .angle_step_rad = to_float_precision(shape_.angle_step_rad),
               .range_min_m = 0.0,
               .range_max_m = kRangeMaxM,
               .period_ns = std::clamp(period_ns, kPeriodMinNs, kPeriodMaxNs)};
  clock_.start(geometry_.period_ns, sweep_ns_);
  buffer_.restart();
}

Result<LrfScan> ScanStream::scan(const ScanLine& line, std::int64_t arrival_ns) {
  if (line.shape != shape_) {
    return Errc::kWrongCount;
  }
  std::int64_t stamp_ns = arrival_ns - sweep_ns_;
  if (line.stamp_s) {
    const auto counter_ms = static_cast<std::uint32_t>(static_cast<std::uint64_t>(*line.stamp_s * 1e3) & kCounterBits);
    const Result<std::int64_t> stamped = clock_.host_ns(counter_ms, arrival_ns);
    if (!stamped.ok()) {
      return stamped.error();
    }
    stamp_ns = stamped.value();
  }
  last_stamp_ns_ = std::max(stamp_ns / 1000 * 1000, last_stamp_ns_ + 1000);
  const std::span<float> ranges_m = buffer_.next(shape_.beams);
  std::copy_n(ranges_m_.begin(), shape_.beams, ranges_m.begin());
  return LrfScan{.stamp_ns = last_stamp_ns_,
                 .arrival_ns = arrival_ns,
                 .start_angle_rad = geometry_.start_angle_rad,
                 .angle_step_rad = geometry_.angle_step_rad,
                 .beam_period_ns = beam_period_ns_,
                 .ranges_m = buffer_.seal()};
}

}  // namespace odoless::csv
