#pragma once

#include <poll.h>

#include <cstdint>
#include <span>

namespace odoless {

/// A device that isn't there, on its line, as the loop sees it.
///
/// Thread: one.
class LoopedDevice {
 public:
  LoopedDevice() = default;
  LoopedDevice(const LoopedDevice&) = delete;
  LoopedDevice& operator=(const LoopedDevice&) = delete;
  virtual ~LoopedDevice() = default;

  /// One round: what its line brought, what is due, and what the line takes.
  virtual void step(std::int64_t now_ns) = 0;
  /// What is to be waited for until the next round; a descriptor of -1: nothing tells.
  [[nodiscard]] virtual pollfd waits_for() = 0;
  /// When something is due although nothing came.
  [[nodiscard]] virtual std::int64_t next_event_ns() const = 0;
  /// Nothing more will come: the drive or the record is over.
  [[nodiscard]] virtual bool is_over() const { return false; }
};

/// Serves devices on one thread and one clock, the monotonic one, until SIGTERM, SIGINT or the duration.
///
/// @param devices       At least one.
/// @param stops_at_end  Stop also when the first of them is over.
void serve_devices(std::span<LoopedDevice* const> devices, std::int64_t duration_ns, bool stops_at_end);

}  // namespace odoless
