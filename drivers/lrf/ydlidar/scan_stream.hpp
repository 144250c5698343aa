#pragma once

#include <cstdint>
#include <span>

#include "drivers/lrf/arrival_clock.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/turn_scans.hpp"
#include "drivers/lrf/ydlidar/packet.hpp"

namespace odoless::ydlidar {

/// How many samples arrive, by the line of least squares through the arrivals: what makes single ones late hardly turns
/// it.
class ArrivalRate {
 public:
  void start() { *this = {}; }
  /// After `samples` more, it is `at_ns`.
  void add(std::size_t samples, std::int64_t at_ns);
  [[nodiscard]] std::int64_t span_ns() const { return span_ns_; }
  /// From sample to sample; 0: not known.
  [[nodiscard]] double sample_ns() const;

 private:
  std::int64_t first_ns_ = 0;
  std::int64_t span_ns_ = 0;
  double count_ = 0.0, samples_ = 0.0;  ///< of the arrivals; of the samples since the first
  double sum_x_ = 0.0, sum_y_ = 0.0, sum_xx_ = 0.0, sum_xy_ = 0.0;
};

/// The stream of turns of one device.
///
/// It sends no stamp, but it samples evenly: the samples' number is the time, their rate is what arrives in a second,
/// and the arrivals are the origin. What was lost, the angles tell. Beams go clockwise from the front, so the angle
/// step is negative.
/// Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// A stream is about to start. Errc::kTooManyBeams: more than there is memory for.
  [[nodiscard]] Errc configure(int line_baud);

  [[nodiscard]] const LrfGeometry& geometry() const { return scans_.geometry(); }

  /// Takes bytes off the front of `bytes`, up to the end of a turn or the first fault. A scan, or why there is none:
  /// Errc::kOk (all bytes are used), kWrongSum, kFrameMalformed (bytes had to be skipped), kWrongCount (a turn that
  /// lacks too many points). Until the rate of the samples is known, there are no scans.
  [[nodiscard]] FoundScan take(std::span<const std::byte>& bytes, std::int64_t arrival_ns);

  [[nodiscard]] std::uint64_t identical_run() const { return scans_.identical_run(); }

 private:
  void on_packet(std::int64_t arrival_ns);
  [[nodiscard]] double lost_samples(std::int64_t sent_ns) const;
  void learn_rate(std::int64_t sent_ns);
  [[nodiscard]] bool take_points();

  LrfRanging ranging_;
  TurnScans scans_;
  PacketReader reader_;
  ArrivalClock clock_{250'000'000};
  int line_baud_ = 0;
  double sample_ns_ = 0.0;  ///< 0: not known yet
  double step_deg_ = 0.0;   ///< from sample to sample
  double last_deg_ = 0.0;   ///< of the last packet's last sample
  double device_ns_ = 0.0;  ///< of that sample, by the samples' number
  bool is_after_fault_ = false;
  ArrivalRate rate_;
  std::size_t next_point_ = 0;  ///< of the packet; the rest waits for the next call
};

}  // namespace odoless::ydlidar
