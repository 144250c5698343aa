#include "tools/emulate/looped_gpio.hpp"

#include <algorithm>
#include <utility>

namespace odoless {

LoopedGpio::LoopedGpio(RobotWires& wires, GpioSimChip& chip, OnOutput on_output)
    : wires_(wires), chip_(chip), on_output_(std::move(on_output)) {}

void LoopedGpio::step(std::int64_t now_ns) {
  wires_.tick(now_ns);
  for (std::size_t i = 0; i < driven_.size(); ++i) {
    if (const bool high = wires_.is_high(static_cast<GpioPin>(i)); high != driven_[i]) {
      chip_.set(i, high);
      driven_[i] = high;
    }
  }
  if (now_ns >= next_look_ns_) {
    next_look_ns_ = now_ns + kLook_ns;
    look(now_ns);
  }
}

void LoopedGpio::look(std::int64_t now_ns) {
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const bool high = chip_.value(i).value_or(false);
    if (i < kGpioInputs) {
      if (high != driven_[i]) {  // whoever opens a line may ask for a pull, which gpio-sim takes for the wire
        chip_.set(i, driven_[i]);
      }
    } else if (high != seen_[i]) {
      on_output_(static_cast<GpioPin>(i), high, now_ns);
    }
    seen_[i] = high;
  }
}

std::int64_t LoopedGpio::next_event_ns() const { return std::min(wires_.next_event_ns(), next_look_ns_); }

}  // namespace odoless
