#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/result.hpp"

namespace odoless {

/// The host's time when a device's clock turned to `device_ms`, as the device said when it was asked.
struct ClockReading {
  std::uint32_t device_ms = 0;
  std::int64_t host_ns = 0;
};

/// Puts a laser's own millisecond counter on the host's clock: host = offset + (1 + drift) * device.
///
/// Bytes only ever arrive late, never early, so the line is the lower envelope of the arrivals of the last 16 s: the
/// edge of their lower convex hull below their mean [moon1999skew], at most 0.12 % of drift. Between the counter's
/// whole milliseconds, the mirror's even turn tells. With 1000 ppm of drift and 5 ms of jitter, a stamp is within 1 ms
/// of the truth after 10 s.
///
/// How late even the earliest bytes are, beyond the delay that is known, only a reading of the device's clock can tell:
/// within the first 2 s after one, the least late scan does.
///
/// Tracks the wrap of the counter's 24 bits. A counter that starts anew (reset, reboot) is seen after three stamps,
/// or eight where it goes on as if it had been late; one that stands still after three, too; then the stamp is the
/// arrival less the delay, so that the host's stamps never jump.
///
/// Thread: one thread. Real time: no allocation; at most 64 steps per call.
class DeviceClock {
 public:
  /// @param period_ns  From stamp to stamp.
  /// @param delay_ns   From the moment that a stamp tells to the arrival of its last byte, when nothing is late.
  void start(std::int64_t period_ns, std::int64_t delay_ns);

  /// The device was asked for its time since the start, and before the first stamp.
  void compare(const ClockReading& reading) { reading_ = reading; }

  /// The host's time of a device stamp: whole microseconds, and later than every one before.
  ///
  /// Errc::kImplausibleStamp: the stamp cannot be; nothing is learned from it.
  [[nodiscard]] Result<std::int64_t> host_ns(std::uint32_t device_ms, std::int64_t arrival_ns);

  /// Times that the counter was seen to start anew.
  [[nodiscard]] std::uint64_t resets() const { return resets_; }

 private:
  static constexpr int kBuckets = 64;

  /// One arrival: when it was by the device's clock since `device_origin_ms_`, and how far the host's clock was ahead
  /// of that, less the delay, since `host_origin_ns_`.
  struct Sample {
    double device_s = 0.0;
    double offset_s = 0.0;
  };

  void restart(std::uint32_t device_ms, std::int64_t arrival_ns);
  [[nodiscard]] std::int64_t unwrapped_ms(std::uint32_t device_ms, std::int64_t arrival_ns) const;
  [[nodiscard]] Sample sample(std::int64_t device_ms, std::int64_t arrival_ns) const;
  [[nodiscard]] double late_s(const Sample& sample) const;
  [[nodiscard]] bool plausible(const Sample& sample) const;
  [[nodiscard]] bool stays_late(const Sample& sample);
  [[nodiscard]] bool confirmed_reset(const Sample& sample);
  void learn(const Sample& sample);
  void fit();
  [[nodiscard]] double even_s(double counter_s);
  void learn_latency(std::uint32_t device_ms, std::int64_t arrival_ns);
  [[nodiscard]] std::int64_t in_order(std::int64_t stamp_ns);

  double period_s_ = 0.0;
  std::int64_t delay_ns_ = 0;
  std::optional<ClockReading> reading_;   ///< while it tells the latency
  std::int64_t earliest_latency_ns_ = 0;  ///< since the reading
  std::int64_t latency_ns_ = 0;           ///< of the earliest bytes, beyond the delay

  bool started_ = false;  ///< an origin is set
  bool fresh_ = true;     ///< the stream is new: what doesn't fit the line starts a new one at once
  std::int64_t device_origin_ms_ = 0;
  std::int64_t host_origin_ns_ = 0;
  std::int64_t last_device_ms_ = 0;  ///< unwrapped
  std::int64_t last_arrival_ns_ = 0;
  std::int64_t last_stamp_ns_ = 0;

  std::uint32_t last_counter_ms_ = 0;  ///< as sent, plausible or not
  int standing_still_ = 0;
  int suspects_ = 0;
  double suspect_offset_s_ = 0.0;
  int late_in_a_row_ = 0;
  double late_offset_s_ = 0.0;
  std::uint64_t resets_ = 0;

  double even_s_ = 0.0;  ///< the last stamp, finer than the counter tells
  double turn_s_ = 0.0;  ///< from stamp to stamp, by the device's clock
  double turns_seen_ = 0.0;
  double offset_s_ = 0.0;
  double drift_ratio_ = 0.0;
  std::array<Sample, kBuckets> earliest_{};  ///< per quarter of a second, the one that was least late; a ring
  int first_ = 0;
  int count_ = 0;
};

}  // namespace odoless
