#include "drivers/lrf/ldrobot/scan_stream.hpp"

#include <algorithm>
#include <cmath>

namespace odoless::ldrobot {
namespace {

constexpr std::int64_t kNominalTurnNs = 100'000'000;  ///< until one was seen
constexpr double kRangeMinM = 0.02;
constexpr double kSlowRangeMaxM = 12.0;          ///< LD06, LD19
constexpr double kQuickRangeMaxM = 25.0;         ///< STL-27L
constexpr std::int64_t kSlowSampleNs = 222'222;  ///< LD06, LD19: 4500 a second
constexpr std::int64_t kQuickSampleNs = 46'296;  ///< STL-27L: 21600 a second
constexpr std::int64_t kGapMaxMs = 2'000;        ///< more are no lost packets: it has started anew
constexpr std::int64_t kLearnMs = 1'000;
constexpr double kRateSlack = 0.1;  ///< by which its rate may be another than nominal

}  // namespace

std::int64_t sample_ns_of(const Packet& packet) {
  const double turned_ns = packet.sweep_deg / std::max(packet.speed_degps, 1.0) * 1e9;
  const double sample_ns = turned_ns / (kPacketPoints - 1);
  const double between_ns = std::sqrt(static_cast<double>(kSlowSampleNs) * static_cast<double>(kQuickSampleNs));
  return sample_ns > 0.0 && sample_ns < between_ns ? kQuickSampleNs : kSlowSampleNs;
}

ScanStream::ScanStream(const LrfParams& params, int beams_max)
    : scans_({.beams = params.ldrobot_beams,
              .range_min_m = kRangeMinM,
              .range_max_m = kSlowRangeMaxM,
              .period_ns = kNominalTurnNs},
             beams_max, 0.0) {}

Errc ScanStream::configure(const Packet& packet, int line_baud) {
  nominal_ns_ = sample_ns_of(packet);
  sample_ns_ = static_cast<double>(nominal_ns_);
  transfer_ns_ = transfer_ns(kPacketBytes, line_baud);
  scans_.set_range_max(nominal_ns_ == kQuickSampleNs ? kQuickRangeMaxM : kSlowRangeMaxM);
  reader_.clear();
  clock_.start();
  counter_ms_.reset();
  device_ns_ = 0.0;
  counted_ms_ = counted_packets_ = 0;
  next_point_ = kPacketPoints;
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
        return {.scan = {}, .error = Errc::kFrameMalformed};
      case PacketReader::Outcome::kWrongSum:
        return {.scan = {}, .error = Errc::kWrongSum};
    }
  }
}

// The counter's milliseconds say how many packets were lost; which of its samples they were is the samples' affair.
void ScanStream::on_packet(std::int64_t arrival_ns) {
  const int now_ms = reader_.packet().counter_ms;
  const double packet_ns = kPacketPoints * sample_ns_;
  next_point_ = 0;
  if (counter_ms_) {
    const std::int64_t elapsed_ms = (now_ms - *counter_ms_ + kCounterWrapMs) % kCounterWrapMs;
    if (elapsed_ms > kGapMaxMs) {
      clock_.start();
      scans_.clear();
    } else {
      const auto packets = std::max<std::int64_t>(std::llround(static_cast<double>(elapsed_ms) * 1e6 / packet_ns), 1);
      device_ns_ += static_cast<double>(packets) * packet_ns;
      learn_rate(elapsed_ms, packets);
    }
  }
  counter_ms_ = now_ms;
  static_cast<void>(clock_.host_ns(std::llround(device_ns_), arrival_ns - transfer_ns_));
}

void ScanStream::learn_rate(std::int64_t elapsed_ms, std::int64_t packets) {
  counted_ms_ += elapsed_ms;
  counted_packets_ += packets;
  if (counted_ms_ < kLearnMs) {
    return;
  }
  const double measured_ns =
      static_cast<double>(counted_ms_) * 1e6 / static_cast<double>(counted_packets_) / kPacketPoints;
  const auto nominal_ns = static_cast<double>(nominal_ns_);
  if (std::abs(measured_ns - nominal_ns) < kRateSlack * nominal_ns) {
    sample_ns_ = measured_ns;
  }
  counted_ms_ = counted_packets_ = 0;
}

bool ScanStream::take_points() {
  const Packet& packet = reader_.packet();
  while (next_point_ < kPacketPoints) {
    const std::size_t point = next_point_++;
    const double before_ns = static_cast<double>(kPacketPoints - 1 - point) * sample_ns_;
    const std::int64_t time_ns = clock_.at_ns(device_ns_ - before_ns);
    const rplidar::Point seen{.angle_deg = packet.angle_deg(point), .range_m = packet.points[point].range_m};
    if (scans_.add(seen, time_ns)) {
      return true;
    }
  }
  return false;
}

}  // namespace odoless::ldrobot
