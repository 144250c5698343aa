#include "drivers/lrf/rplidar/scan_stream.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::int64_t kNominalTurnNs = 180'000'000;  ///< until one was seen
constexpr double kRangeMinM = 0.15;
constexpr double kRangeMaxM = 25.0;  ///< where the device doesn't say

}  // namespace

ScanStream::ScanStream(const LrfParams& params, int beams_max)
    : scans_({.beams = params.rplidar_beams,
              .range_min_m = kRangeMinM,
              .range_max_m = kRangeMaxM,
              .period_ns = kNominalTurnNs},
             beams_max, kCompensationMaxDeg) {}

Errc ScanStream::configure(const ScanMode& mode, int line_baud) {
  mode_ = mode;
  reader_.start(mode.format);
  transfer_ns_ = transfer_ns(reader_.packet_bytes(), line_baud);
  scans_.set_range_max(mode.range_max_m > 0.0 ? mode.range_max_m : kRangeMaxM);
  clock_.start();
  next_point_ = 0;
  return scans_.start();
}

FoundScan ScanStream::take(std::span<const std::byte>& bytes, std::int64_t arrival_ns) {
  for (;;) {
    if (take_points()) {
      return scans_.finish(arrival_ns);
    }
    switch (reader_.take(bytes)) {
      case PointReader::Outcome::kMore:
        return {};
      case PointReader::Outcome::kPoints:
        next_point_ = 0;
        static_cast<void>(clock_.host_ns(reader_.last_sample() * mode_.sample_ns, arrival_ns - transfer_ns_));
        break;
      case PointReader::Outcome::kSkipped:
        if (mode_.format == nullptr) {
          scans_.spoil();
        }
        return {.scan = {}, .error = Errc::kFrameMalformed};
      case PointReader::Outcome::kBroken:
        scans_.clear();
        return {.scan = {}, .error = Errc::kFrameMalformed};
      case PointReader::Outcome::kWrongSum:
        return {.scan = {}, .error = Errc::kWrongSum};
    }
  }
}

bool ScanStream::take_points() {
  const std::span<const Point> points = reader_.points();
  while (next_point_ < points.size()) {
    const std::int64_t sample = reader_.first_sample() + static_cast<std::int64_t>(next_point_);
    const Point& point = points[next_point_++];
    if (scans_.add(point, clock_.at_ns(sample * mode_.sample_ns))) {
      return true;
    }
  }
  return false;
}

}  // namespace odoless::rplidar
