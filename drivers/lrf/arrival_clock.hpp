#pragma once

#include <cstddef>
#include <cstdint>

namespace odoless {

/// What bytes take on a serial line, start and stop bit included; 0 where its rate isn't known.
[[nodiscard]] constexpr std::int64_t transfer_ns(std::size_t bytes, int line_baud) {
  return line_baud == 0 ? 0 : static_cast<std::int64_t>(bytes) * 10 * 1'000'000'000 / line_baud;
}

/// Puts what a device without a clock of its own counts evenly (turns of a mirror, samples) on the host's clock.
///
/// Bytes only ever arrive late, never early: the least late arrival of the last while tells the offset. One that is
/// earlier counts at once, later ones (something was lost, or the device counts slower) at the end of the while.
///
/// Thread: one thread. Real time: constant time, no allocation.
class ArrivalClock {
 public:
  explicit ArrivalClock(std::int64_t while_ns) : while_ns_(while_ns) {}

  /// The counting starts anew.
  void start() { fresh_ = true; }

  /// The host's time of `device_ns`, which arrived at `arrival_ns` (less whatever way is known). Never later than the
  /// arrival.
  [[nodiscard]] std::int64_t host_ns(std::int64_t device_ns, std::int64_t arrival_ns);

  /// The same without learning: of a moment shortly before the last one.
  [[nodiscard]] std::int64_t at_ns(std::int64_t device_ns) const { return offset_ns_ + device_ns; }
  /// Of a moment that is not a whole nanosecond: less than one off.
  [[nodiscard]] std::int64_t at_ns(double device_ns) const { return at_ns(static_cast<std::int64_t>(device_ns)); }

 private:
  std::int64_t while_ns_;
  bool fresh_ = true;
  std::int64_t offset_ns_ = 0;
  std::int64_t window_start_ns_ = 0;     ///< by the device
  std::int64_t window_earliest_ns_ = 0;  ///< least offset in the window
};

}  // namespace odoless
