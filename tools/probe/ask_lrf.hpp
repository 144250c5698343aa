#pragma once

#include <cstdint>

#include "core/base/result.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

/// Brings a laser up, as the daemon would, and returns what it says of itself; it is left streaming.
///
/// Errors: those of DeviceLine::open; Errc::kDeviceSilent where nothing answers within `patience_ns`.
[[nodiscard]] Result<LrfGeometry> ask_lrf(const LrfParams& params, std::int64_t patience_ns);

}  // namespace odoless
