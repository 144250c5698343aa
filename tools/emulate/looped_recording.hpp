#pragma once

#include "tools/emulate/device_loop.hpp"
#include "tools/emulate/raw_player.hpp"
#include "tools/emulate/servo_line.hpp"

namespace odoless {

/// A recorded device, laser or servo, on its line; both must outlive it.
class LoopedRecording final : public LoopedDevice {
 public:
  LoopedRecording(RawPlayer& player, ServoLine& line) : player_(player), line_(line) {}

  void step(std::int64_t now_ns) override;
  [[nodiscard]] pollfd waits_for() override { return odoless::waits_for(line_); }
  [[nodiscard]] std::int64_t next_event_ns() const override { return player_.next_event_ns(); }
  [[nodiscard]] bool is_over() const override { return player_.is_over() && !line_.has_waiting(); }

 private:
  RawPlayer& player_;
  ServoLine& line_;
};

}  // namespace odoless
