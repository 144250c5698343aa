#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/lrf/device_clock.hpp"
#include "drivers/lrf/scip/replies.hpp"

namespace odoless::scip {

/// Asks a device for the time of its clock, a few times, in the mode in which it tells it (TM0, TM1, TM2).
///
/// Each answer says that the clock showed its time between the question and the answer, the line's own time taken off;
/// what all answers agree in is the reading, which is finer than the clock's milliseconds where answers come quickly.
/// Thread: one thread. Real time: no allocation.
class TimeQuery {
 public:
  /// @param line_baud  For the line's own time; 0: it takes none.
  void start(int line_baud);

  [[nodiscard]] bool done() const { return stage_ > kLeave; }
  /// The next request, which is sent at `now_ns`.
  [[nodiscard]] std::string_view request(std::int64_t now_ns);
  /// Whether `reply` answers the request; then the next one is due, or it is done.
  [[nodiscard]] bool on_reply(const Reply& reply, std::int64_t now_ns);

  /// Nothing where the device doesn't tell its time, or its answers contradict one another.
  [[nodiscard]] std::optional<ClockReading> reading() const;

 private:
  static constexpr int kEnter = 0;
  static constexpr int kLeave = 9;  ///< in between it is asked

  [[nodiscard]] std::string_view name() const;
  void learn(std::uint32_t device_ms, std::int64_t now_ns);

  int stage_ = kLeave + 1;
  std::int64_t request_way_ns_ = 0;
  std::int64_t reply_way_ns_ = 0;
  std::int64_t asked_ns_ = 0;
  std::optional<std::uint32_t> first_ms_;
  std::int64_t earliest_ns_ = 0;  ///< at which the device's clock showed `first_ms_`
  std::int64_t latest_ns_ = 0;
};

}  // namespace odoless::scip
