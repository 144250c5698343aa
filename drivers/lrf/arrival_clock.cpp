#include "drivers/lrf/arrival_clock.hpp"

#include <algorithm>

namespace odoless {

std::int64_t ArrivalClock::host_ns(std::int64_t device_ns, std::int64_t arrival_ns) {
  const std::int64_t offset_ns = arrival_ns - device_ns;
  if (fresh_) {
    fresh_ = false;
    offset_ns_ = offset_ns;
    window_start_ns_ = device_ns;
    window_earliest_ns_ = offset_ns;
  }
  window_earliest_ns_ = std::min(window_earliest_ns_, offset_ns);
  offset_ns_ = std::min(offset_ns_, offset_ns);
  if (device_ns - window_start_ns_ >= while_ns_) {
    offset_ns_ = window_earliest_ns_;
    window_start_ns_ = device_ns;
    window_earliest_ns_ = offset_ns;
  }
  return at_ns(device_ns);
}

}  // namespace odoless
