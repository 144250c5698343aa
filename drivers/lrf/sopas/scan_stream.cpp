#include "drivers/lrf/sopas/scan_stream.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/float_precision.hpp"

namespace odoless::sopas {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kFrontDeg = 90.0;
constexpr double kDegPerTmdeg = 1e-4;
constexpr std::uint16_t kFirstRange = 16;  ///< lower counts are codes: too dark, too near, too far, dazzled
constexpr double kRangeMinM = 0.05;
constexpr double kScansMinHz = 1.0;
constexpr double kScansMaxHz = 1000.0;
constexpr std::uint32_t kOnItsWayMaxUs = 1'000'000;
constexpr std::uint32_t kUsPerMs = 1000;
constexpr double kFacesMax = 12.0;

/// How many scans a turn of the mirror has: a polygon sees a part of the circle with each of its faces. It is told by
/// how many measurements the time of a scan has room for.
double faces_of_mirror(const ScanData& data, double step) {
  const double per_turn = 360.0 / step;
  const double per_scan = data.measurements_khz * 1e3 / data.scans_hz;
  return per_scan > 0.0 ? std::clamp(std::round(per_turn / per_scan), 1.0, kFacesMax) : 1.0;
}

}  // namespace

double bearing_rad(double sick_deg) { return (sick_deg - kFrontDeg) * kRadPerDeg; }

double step_deg(int step_tmdeg) {
  const double told_deg = step_tmdeg * kDegPerTmdeg;
  const double fraction_deg = 1.0 / std::round(1.0 / told_deg);
  return std::abs(fraction_deg - told_deg) < kDegPerTmdeg ? fraction_deg : told_deg;
}

ScanStream::ScanStream(const LrfParams& /*params*/, int beams_max)
    : counts_(static_cast<std::size_t>(beams_max)), buffer_(beams_max) {}

Result<ScanData> ScanStream::read(const Telegram& telegram) { return scan_data_of(telegram, counts_); }

Errc ScanStream::configure(const ScanData& first, int scans_per_telegram) {
  if (first.scans_hz < kScansMinHz || first.scans_hz > kScansMaxHz) {
    return Errc::kBadGeometry;
  }
  shape_ = first.shape;
  const double scan_ns = 1e9 / first.scans_hz;
  const double start_deg = shape_.start_tmdeg * kDegPerTmdeg;
  const double step = step_deg(shape_.step_tmdeg);
  const double faces = faces_of_mirror(first, step);
  const double beam_ns = scan_ns * faces * step / 360.0;
  const double sweep_ns = beam_ns * (shape_.beams - 1);
  const bool is_stamped_at_end = (first.sending_us - first.stamp_us) * 1e3 < sweep_ns;
  beam_period_ns_ = std::llround(beam_ns);
  to_first_beam_ns_ =
      std::llround(is_stamped_at_end ? -sweep_ns : scan_ns * (0.5 + (start_deg - kFrontDeg) * faces / 360.0));
  geometry_ = {.beams = shape_.beams,
               .start_angle_rad = to_float_precision(bearing_rad(start_deg)),
               .angle_step_rad = to_float_precision(step * kRadPerDeg),
               .range_min_m = kRangeMinM,
               .range_max_m = 65535.0 * static_cast<double>(shape_.scale) * 1e-3,
               .period_ns = std::llround(scan_ns * scans_per_telegram)};
  clock_.start(geometry_.period_ns, 0);
  buffer_.restart();
  return Errc::kOk;
}

float ScanStream::range_m(std::uint16_t count) const {
  const float range_mm = static_cast<float>(count) * shape_.scale + shape_.offset;
  return count < kFirstRange ? 0.0F : std::max(range_mm * 1e-3F, 0.0F);
}

Result<LrfScan> ScanStream::scan(const ScanData& data, std::int64_t arrival_ns) {
  if (data.shape != shape_) {
    return Errc::kWrongCount;
  }
  const std::uint32_t on_its_way_us = data.sending_us - data.stamp_us;
  if (on_its_way_us > kOnItsWayMaxUs) {
    return Errc::kImplausibleStamp;
  }
  stamp_us_ += static_cast<std::int32_t>(data.stamp_us - last_stamp_us_);
  last_stamp_us_ = data.stamp_us;
  const auto counter_ms = static_cast<std::uint32_t>(stamp_us_ / kUsPerMs) & 0xFFFFFFU;
  const Result<std::int64_t> stamp_ns =
      clock_.host_ns(counter_ms, arrival_ns - static_cast<std::int64_t>(on_its_way_us) * 1000);
  if (!stamp_ns.ok()) {
    return stamp_ns.error();
  }
  const std::span<float> ranges_m = buffer_.next(shape_.beams);
  std::transform(counts_.begin(), counts_.begin() + shape_.beams, ranges_m.begin(),
                 [&](std::uint16_t count) { return range_m(count); });
  return LrfScan{.stamp_ns = (stamp_ns.value() + to_first_beam_ns_) / 1000 * 1000,
                 .arrival_ns = arrival_ns,
                 .start_angle_rad = geometry_.start_angle_rad,
                 .angle_step_rad = geometry_.angle_step_rad,
                 .beam_period_ns = beam_period_ns_,
                 .ranges_m = buffer_.seal()};
}

}  // namespace odoless::sopas
