#include "firmware/gpio/status_light.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kPattern_ms = 2000;
constexpr std::int64_t kFlash_ms = 100;

/// The first `count` of slots of twice a flash are half on.
bool flashes(std::int64_t count, std::int64_t time_ms) {
  return time_ms / (2 * kFlash_ms) < count && time_ms % (2 * kFlash_ms) < kFlash_ms;
}

}  // namespace

bool status_light_is_on(HealthState state, bool stopped, std::int64_t now_ns) {
  const std::int64_t time_ms = now_ns / 1'000'000 % kPattern_ms;
  if (stopped) {
    return flashes(4, time_ms);
  }
  switch (state) {
    case HealthState::kInit:
      return time_ms < kPattern_ms / 2;
    case HealthState::kOk:
      return !flashes(1, time_ms);
    case HealthState::kDegraded:
      return flashes(2, time_ms);
    case HealthState::kLost:
      return flashes(3, time_ms);
    case HealthState::kFault:
      return flashes(kPattern_ms / (2 * kFlash_ms), time_ms);
  }
  return false;
}

}  // namespace odoless
