#include "tools/emulate/emulated_gpio.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace odoless {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

}  // namespace

EmulatedGpio::EmulatedGpio(std::vector<Fault> faults, PulseTime pulse_ns, std::int64_t now_ns)
    : faults_(std::move(faults)), pulse_ns_(std::move(pulse_ns)), start_ns_(now_ns), now_ns_(now_ns) {}

void EmulatedGpio::tick(std::int64_t now_ns) {
  now_ns_ = now_ns;
  if (!pulse_ns_) {
    return;
  }
  const auto is_past = [&](std::int64_t index) {
    const std::int64_t time_ns = pulse_ns_(index);
    return time_ns != kNever && time_ns + kPulse_ns <= now_ns;
  };
  while (is_past(next_pulse_)) {
    is_pulse_ = false;
    ++next_pulse_;
  }
  const bool is_silent = active_fault(faults_, FaultKind::kSilence, now_ns - start_ns_) != nullptr;
  if (!is_pulse_ && !is_silent && pulse_ns_(next_pulse_) <= now_ns) {
    is_pulse_ = true;
    ++pulses_;
  }
}

std::int64_t EmulatedGpio::next_event_ns() const {
  std::int64_t next_ns = kNever;
  if (pulse_ns_ && pulse_ns_(next_pulse_) != kNever) {
    const std::int64_t begin_ns = pulse_ns_(next_pulse_);
    next_ns = begin_ns > now_ns_ ? begin_ns : begin_ns + kPulse_ns;
  }
  for (const Fault& fault : faults_) {
    for (const std::int64_t edge_ns : {fault.start_ns, fault.end_ns}) {
      if (edge_ns != kNever && start_ns_ + edge_ns > now_ns_) {
        next_ns = std::min(next_ns, start_ns_ + edge_ns);
      }
    }
  }
  return next_ns;
}

bool EmulatedGpio::is_high(GpioPin input) const {
  return input == GpioPin::kSync ? is_pulse_ : active_fault(faults_, FaultKind::kStop, now_ns_ - start_ns_) == nullptr;
}

}  // namespace odoless
