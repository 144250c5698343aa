#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace odoless {

/// Puts scans on the pulses that a laser's mirror gives once per turn, stamped by the kernel: free of the line's jitter
/// and of the laser's own clock.
///
/// A scan's first beam comes `delay_ns` after its turn's pulse. The stamp that the session made of the laser's own
/// clock says which pulse that is, so it may be wrong by up to a quarter of a turn.
///
/// Thread: one thread. Real time: no allocation; at most about 50 steps per call.
class SyncClock {
 public:
  explicit SyncClock(std::int64_t delay_ns) : delay_ns_(delay_ns) {}

  /// A pulse; one that isn't later than the last is ignored.
  void on_pulse(std::int64_t stamp_ns);

  /// The stamp of a scan by its pulse, in whole microseconds; `stamp_ns` itself where there is no pulse that fits.
  [[nodiscard]] std::int64_t refine(std::int64_t stamp_ns);

  /// How many of the last scans in a row had no pulse.
  [[nodiscard]] std::int64_t missed_in_a_row() const { return missed_in_a_row_; }

 private:
  static constexpr std::size_t kPulses = 16;

  [[nodiscard]] std::int64_t usual_turn_ns() const;

  std::int64_t delay_ns_;
  std::array<std::int64_t, kPulses> pulses_ns_{};  ///< a ring
  std::int64_t count_ = 0;
  std::int64_t missed_in_a_row_ = 0;
};

}  // namespace odoless
