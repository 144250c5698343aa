#pragma once

#include <cstdint>

#include "core/base/result.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

/// What a laser says of itself.
struct LrfAnswer {
  LrfParams params;               ///< as asked, but with the rate, variant and unit that it has
  LrfGeometry geometry;           ///< its period is measured, where that takes a scan, only if `has_scanned`
  bool has_scanned = true;        ///< false: it answers, but gave no scan
  bool is_to_be_written = false;  ///< the daemon must write its memory all the same: no parameter says what it has
};

/// Asks a laser what it is, and changes nothing that it keeps without power. SICK's are only asked what they are set to
/// and don't stream then; the others are brought up, as the daemon would, until a scan comes, and are left streaming.
///
/// Errors: those of DeviceLine::open; Errc::kDeviceSilent where nothing answers within `patience_ns`, and kDeviceStatus
/// where all that it says is that it is broken. The first scan may take as long again.
[[nodiscard]] Result<LrfAnswer> ask_lrf(const LrfParams& params, std::int64_t patience_ns);

}  // namespace odoless
