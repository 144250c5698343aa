#include "drivers/lrf/ydlidar/scan_stream.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace odoless::ydlidar {
namespace {

constexpr std::int64_t kNominalTurnNs = 143'000'000;  ///< until one was seen
constexpr double kRangeMinM = 0.10;
constexpr double kTriangleRangeMaxM = 16.0;
constexpr double kTimeOfFlightRangeMaxM = 50.0;
constexpr double kTriangleUnitM = 0.00025;
constexpr double kTimeOfFlightUnitM = 0.001;
constexpr std::int64_t kFirstLearnNs = 500'000'000;
constexpr std::int64_t kLearnNs = 2'000'000'000;
constexpr double kRateSlack = 0.05;  ///< by which a rate may be wrong that was learnt
constexpr double kRateGain = 0.5;
constexpr std::int64_t kGapMaxNs = 500'000'000;
constexpr std::size_t kSamplesForStep = 8;
constexpr double kTurnDeg = 360.0;

bool is_triangle(LrfRanging ranging) { return ranging == LrfRanging::kTriangle; }

}  // namespace

void ArrivalRate::add(std::size_t samples, std::int64_t at_ns) {
  if (count_ == 0.0) {
    first_ns_ = at_ns;
  } else {
    samples_ += static_cast<double>(samples);
  }
  span_ns_ = at_ns - first_ns_;
  const auto y = static_cast<double>(span_ns_);
  count_ += 1.0;
  sum_x_ += samples_;
  sum_y_ += y;
  sum_xx_ += samples_ * samples_;
  sum_xy_ += samples_ * y;
}

double ArrivalRate::sample_ns() const {
  const double spread = count_ * sum_xx_ - sum_x_ * sum_x_;
  return spread > 0.0 ? (count_ * sum_xy_ - sum_x_ * sum_y_) / spread : 0.0;
}

ScanStream::ScanStream(const LrfParams& params, int beams_max)
    : ranging_(params.ydlidar_ranging),
      scans_({.beams = params.ydlidar_beams,
              .range_min_m = kRangeMinM,
              .range_max_m = is_triangle(params.ydlidar_ranging) ? kTriangleRangeMaxM : kTimeOfFlightRangeMaxM,
              .period_ns = kNominalTurnNs},
             beams_max, is_triangle(params.ydlidar_ranging) ? kParallaxMaxDeg : 0.0) {}

Errc ScanStream::configure(int line_baud) {
  line_baud_ = line_baud;
  sample_ns_ = step_deg_ = device_ns_ = 0.0;
  is_after_fault_ = false;
  rate_.start();
  reader_.clear();
  clock_.start();
  next_point_ = kSamplesMax;
  return scans_.start();
}

FoundScan ScanStream::take(std::span<const std::byte>& bytes, std::int64_t arrival_ns) {
  for (;;) {
    if (take_points()) {
      return scans_.finish(arrival_ns);
    }
    switch (reader_.take(bytes)) {
      case PacketReader::Outcome::kMore:
        return {};
      case PacketReader::Outcome::kPacket:
        on_packet(arrival_ns);
        break;
      case PacketReader::Outcome::kSkipped:
        is_after_fault_ = true;
        return {.scan = {}, .error = Errc::kFrameMalformed};
      case PacketReader::Outcome::kWrongSum:
        is_after_fault_ = true;
        return {.scan = {}, .error = Errc::kWrongSum};
    }
  }
}

void ScanStream::on_packet(std::int64_t arrival_ns) {
  const Packet& packet = reader_.packet();
  const std::int64_t sent_ns = arrival_ns - transfer_ns(packet.size_bytes(), line_baud_);
  next_point_ = 0;
  if (packet.count >= kSamplesForStep) {
    step_deg_ = packet.sweep_deg / static_cast<double>(packet.count - 1);
  }
  const double lost = is_after_fault_ ? lost_samples(sent_ns) : 0.0;
  if (std::exchange(is_after_fault_, false)) {
    rate_.start();
  }
  device_ns_ += (lost + static_cast<double>(packet.count)) * sample_ns_;
  last_deg_ = packet.angle_deg(packet.count - 1);
  learn_rate(sent_ns);
  if (sent_ns - clock_.at_ns(device_ns_) > kGapMaxNs) {
    clock_.start();
    scans_.clear();
  }
  static_cast<void>(clock_.host_ns(std::llround(device_ns_), sent_ns));
}

// The angles tell how many within a turn, the arrival how many turns.
double ScanStream::lost_samples(std::int64_t sent_ns) const {
  if (sample_ns_ <= 0.0 || step_deg_ <= 0.0) {
    return 0.0;
  }
  const Packet& packet = reader_.packet();
  const double gap_deg = std::fmod(packet.first_deg - last_deg_ - step_deg_ / 2.0 + 2.0 * kTurnDeg, kTurnDeg);
  const double lost = std::floor(gap_deg / step_deg_);
  const double turn = kTurnDeg / step_deg_;
  const double at_ns = device_ns_ + (lost + static_cast<double>(packet.count)) * sample_ns_;
  const auto late_ns = static_cast<double>(sent_ns - clock_.at_ns(at_ns));
  return lost + std::max(0.0, std::round(late_ns / (turn * sample_ns_))) * turn;
}

void ScanStream::learn_rate(std::int64_t sent_ns) {
  rate_.add(reader_.packet().count, sent_ns);
  const bool is_first = sample_ns_ <= 0.0;
  if (rate_.span_ns() < (is_first ? kFirstLearnNs : kLearnNs) || rate_.sample_ns() <= 0.0) {
    return;
  }
  if (is_first) {
    clock_.start();
  }
  const double measured_ns = rate_.sample_ns();
  const bool is_near = std::abs(measured_ns - sample_ns_) < kRateSlack * sample_ns_;
  sample_ns_ = is_near ? sample_ns_ + kRateGain * (measured_ns - sample_ns_) : measured_ns;
  rate_.start();
}

bool ScanStream::take_points() {
  const Packet& packet = reader_.packet();
  if (sample_ns_ <= 0.0) {
    return false;
  }
  while (next_point_ < packet.count) {
    const std::size_t i = next_point_++;
    const double range_m = packet.samples[i] * (is_triangle(ranging_) ? kTriangleUnitM : kTimeOfFlightUnitM);
    const double ahead_deg = is_triangle(ranging_) && range_m > 0.0 ? parallax_deg(range_m) : 0.0;
    const double before_ns = static_cast<double>(packet.count - 1 - i) * sample_ns_;
    const std::int64_t time_ns = clock_.at_ns(device_ns_ - before_ns);
    if (scans_.add({.angle_deg = packet.angle_deg(i) + ahead_deg, .range_m = range_m}, time_ns)) {
      return true;
    }
  }
  return false;
}

}  // namespace odoless::ydlidar
