#include "tools/emulate/device_loop.hpp"

#include <algorithm>
#include <vector>

#include "rt/cpu_clock.hpp"
#include "tools/emulate/stop_signals.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kLongest_ns = 200'000'000;  ///< between rounds
constexpr std::int64_t kIdle_ns = 20'000'000;      ///< where a line doesn't tell

void wait(std::span<LoopedDevice* const> devices, std::int64_t end_ns, const sigset_t& mask) {
  std::vector<pollfd> lines;
  std::int64_t until_ns = std::min(end_ns, monotonic_ns() + kLongest_ns);
  for (LoopedDevice* const device : devices) {
    lines.push_back(device->waits_for());
    until_ns = std::min(until_ns, device->next_event_ns());
    if (lines.back().fd < 0) {
      until_ns = std::min(until_ns, monotonic_ns() + kIdle_ns);
    }
  }
  const timespec timeout{.tv_sec = 0, .tv_nsec = std::clamp<std::int64_t>(until_ns - monotonic_ns(), 0, kLongest_ns)};
  static_cast<void>(::ppoll(lines.data(), lines.size(), &timeout, &mask));
}

}  // namespace

void serve_devices(std::span<LoopedDevice* const> devices, std::int64_t duration_ns, bool stops_at_end) {
  const StopSignals signals;
  const std::int64_t end_ns = monotonic_ns() + std::min(duration_ns, std::int64_t{1} << 62U);
  while (!StopSignals::stopped() && monotonic_ns() < end_ns) {
    for (LoopedDevice* const device : devices) {
      device->step(monotonic_ns());
    }
    if (stops_at_end && devices.front()->is_over()) {
      return;
    }
    wait(devices, end_ns, signals.mask());
  }
}

}  // namespace odoless
