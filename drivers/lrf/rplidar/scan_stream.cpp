#include "drivers/lrf/rplidar/scan_stream.hpp"

#include <algorithm>
#include <numbers>

namespace odoless::rplidar {
namespace {

constexpr std::int64_t kNominalTurnNs = 180'000'000;  ///< until one was seen
constexpr double kKnownShareMin = 0.8;                ///< of the beams of a scan that is passed on
constexpr double kRangeMinM = 0.15;
constexpr double kRangeMaxM = 25.0;

double to_float_precision(double value) {
  const volatile auto rounded = static_cast<float>(value);  // volatile: see scip/scan_stream.cpp
  return static_cast<double>(rounded);
}

}  // namespace

ScanStream::ScanStream(const LrfParams& params, int beams_max)
    : scan_(params.rplidar_scan), buffer_(beams_max), reader_(params.rplidar_scan) {
  geometry_ = {.beams = params.rplidar_beams,
               .start_angle_rad = 0.0,
               .angle_step_rad = to_float_precision(-2.0 * std::numbers::pi / params.rplidar_beams),
               .range_min_m = kRangeMinM,
               .range_max_m = kRangeMaxM,
               .period_ns = kNominalTurnNs};
}

Errc ScanStream::configure(std::int64_t sample_ns, int line_baud) {
  if (geometry_.beams > buffer_.beams_max()) {
    return Errc::kTooManyBeams;
  }
  sample_ns_ = sample_ns;
  const std::int64_t bytes = scan_ == RplidarScan::kStandard ? kNodeBytes : kCapsuleBytes;
  transfer_ns_ = line_baud == 0 ? 0 : bytes * 10 * 1'000'000'000 / line_baud;
  geometry_.period_ns = kNominalTurnNs;
  reader_.clear();
  turn_.clear();
  clock_.start();
  buffer_.restart();
  next_point_ = 0;
  return Errc::kOk;
}

ScanStream::Found ScanStream::take(std::span<const std::byte>& bytes, std::int64_t arrival_ns) {
  for (;;) {
    if (const std::optional<Found> found = take_points(arrival_ns); found.has_value()) {
      return *found;
    }
    switch (reader_.take(bytes)) {
      case PointReader::Outcome::kMore:
        return {};
      case PointReader::Outcome::kPoints:
        next_point_ = 0;
        static_cast<void>(clock_.host_ns(reader_.last_sample() * sample_ns_, arrival_ns - transfer_ns_));
        break;
      case PointReader::Outcome::kSkipped:
        if (scan_ == RplidarScan::kStandard) {
          turn_.spoil();
        }
        return {.scan = {}, .error = Errc::kFrameMalformed};
      case PointReader::Outcome::kBroken:
        turn_.clear();
        return {.scan = {}, .error = Errc::kFrameMalformed};
      case PointReader::Outcome::kWrongSum:
        return {.scan = {}, .error = Errc::kWrongSum};
    }
  }
}

std::optional<ScanStream::Found> ScanStream::take_points(std::int64_t arrival_ns) {
  const std::span<const Point> points = reader_.points();
  while (next_point_ < points.size()) {
    const std::int64_t sample = reader_.first_sample() + static_cast<std::int64_t>(next_point_);
    const Point& point = points[next_point_++];
    if (turn_.add(point, clock_.at_ns(sample * sample_ns_)) && turn_.is_whole()) {
      return finish_turn(arrival_ns);
    }
  }
  return {};
}

ScanStream::Found ScanStream::finish_turn(std::int64_t arrival_ns) {
  const std::span<float> ranges_m = buffer_.next(geometry_.beams);
  const int known = turn_.resample(ranges_m);
  if (turn_.is_spoilt() || known < kKnownShareMin * geometry_.beams) {
    return {.scan = {}, .error = Errc::kWrongCount};
  }
  geometry_.period_ns = std::clamp<std::int64_t>(turn_.period_ns(), 20'000'000, 2'000'000'000);
  last_stamp_ns_ = std::max(turn_.start_ns() / 1000 * 1000, last_stamp_ns_ + 1000);
  return {.scan = LrfScan{.stamp_ns = last_stamp_ns_,
                          .arrival_ns = arrival_ns,
                          .start_angle_rad = geometry_.start_angle_rad,
                          .angle_step_rad = geometry_.angle_step_rad,
                          .beam_period_ns = geometry_.period_ns / geometry_.beams,
                          .ranges_m = buffer_.seal()},
          .error = Errc::kOk};
}

}  // namespace odoless::rplidar
