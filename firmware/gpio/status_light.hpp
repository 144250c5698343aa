#pragma once

#include <cstdint>

#include "firmware/records/health.hpp"

namespace odoless {

/// Whether the status light shines now. Each pattern lasts 2 s and changes at least once, so that a light that stands
/// still says that nobody drives it:
///
///   stopped    dark, four short flashes
///   INIT       slow and even: 1 s on, 1 s off
///   OK         on, with one short gap
///   DEGRADED   dark, two short flashes
///   LOST       dark, three short flashes
///   FAULT      fast and even: five times a second
///
/// @param stopped  The emergency stop, which goes before all else.
[[nodiscard]] bool status_light_is_on(HealthState state, bool stopped, std::int64_t now_ns);

}  // namespace odoless
