#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/io/gpio_line.hpp"
#include "firmware/gpio/gpio_params.hpp"
#include "firmware/gpio/gpio_recorder.hpp"
#include "firmware/gpio/gpio_signals.hpp"
#include "firmware/gpio/laser_power.hpp"
#include "rt/clock.hpp"
#include "rt/real_time_thread.hpp"
#include "rt/stop_flag.hpp"
#include "rt/wake_up.hpp"

namespace odoless {

/// Serves all GPIO lines on a thread of its own: emergency stop, sync pulse, the laser's power, status light. It opens
/// the lines, and opens them again when their chip was gone.
///
/// The stop is fail-safe: edges only wake the thread, the level decides, and is read every 20 ms besides; a line that
/// cannot be read is a stop, and a stop ends when its line has been good for 100 ms. A call on a line may hang, as on a
/// bus that is stuck: `GpioSignals::round_ns` tells it. In the end power is left on and the light is put out. What is
/// on the lines goes to the record.
///
/// Thread: that of the supervisor. The thread inside is woken by priority but allocates while it opens lines.
class GpioThread {
 public:
  /// @param signals  `stopped` is set at once where there is a stop line.
  /// @param sensor   Notified of each change of `stopped`.
  /// @param outbox   To the publisher; this thread's alone.
  GpioThread(const GpioParams& params, GpioSignals& signals, const MonotonicClock& clock, const WakeUp& sensor,
             Outbox& outbox);
  GpioThread(const GpioThread&) = delete;
  GpioThread& operator=(const GpioThread&) = delete;
  ~GpioThread();

  /// Does nothing where no line is configured. @return 0, or the errno for which there is no thread.
  [[nodiscard]] int start();

 private:
  static constexpr std::int64_t kRound_ns = 20'000'000;
  static constexpr std::int64_t kReopen_ns = 250'000'000;
  static constexpr std::int64_t kReleased_ns = 100'000'000;

  void run();
  void open_lines(std::int64_t now_ns);
  [[nodiscard]] bool has_all_lines() const;
  void wait();
  void serve_stop(std::int64_t now_ns);
  void serve_sync(std::int64_t now_ns);
  void serve_outputs(std::int64_t now_ns);
  /// Sets an output, or gives it up where it is lost.
  void set_output(std::optional<GpioLine>& line, GpioPin pin, bool high, std::int64_t now_ns);
  void set_stopped(bool stopped);

  GpioParams params_;
  GpioSignals& signals_;
  const MonotonicClock& clock_;
  const WakeUp& sensor_;
  GpioRecorder recorder_;
  LaserPower power_;
  std::optional<GpioLine> stop_line_;
  std::optional<GpioLine> sync_line_;
  std::optional<GpioLine> power_line_;
  std::optional<GpioLine> led_line_;
  std::int64_t next_open_ns_ = 0;
  std::int64_t good_since_ns_ = -1;  ///< the stop's level; -1: it isn't good
  StopFlag ending_;
  RealTimeThread thread_;
};

}  // namespace odoless
