#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/gpio/gpio_change.hpp"
#include "firmware/pipeline/outbox.hpp"

namespace odoless {

/// Tells the publisher what is on the GPIO lines, for the record: each change with its time.
///
/// Thread: GPIO thread. Real time: no allocation; what finds no room in the outbox is counted by it.
class GpioRecorder {
 public:
  explicit GpioRecorder(Outbox& outbox) : outbox_(outbox) {}

  /// An edge as the kernel tells of it; not told again where its level was read before the edge came.
  void on_edge(GpioPin pin, bool high, std::int64_t stamp_ns);
  /// What was read from a line, or set, or that it is lost: told where it is no longer what was told last.
  void on_level(GpioPin pin, GpioLevel level, std::int64_t stamp_ns);

 private:
  void tell(const GpioChange& change, std::int64_t stamp_ns);

  Outbox& outbox_;
  std::array<std::optional<GpioLevel>, kGpioPinNames.size()> told_{};
  std::array<bool, kGpioPinNames.size()> told_before_its_edge_{};
};

}  // namespace odoless
