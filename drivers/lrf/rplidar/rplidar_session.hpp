#pragma once

#include "drivers/lrf/rplidar/bring_up.hpp"
#include "drivers/lrf/rplidar/scan_stream.hpp"
#include "drivers/lrf/turning_session.hpp"

namespace odoless {

/// Slamtec RPLIDAR, A, C and S series: brings the device up, makes scans of evenly spaced beams from its points, and
/// brings it up again when the stream ends or stalls.
///
/// One damaged byte costs at most one scan. The standard scan has no sums: a byte that changes a range within what is
/// possible cannot be told. Contract: see LrfSession.
class RplidarSession final : public TurningSession<rplidar::ScanStream, rplidar::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; more in `params` are refused with Errc::kTooManyBeams.
  RplidarSession(const LrfParams& params, int beams_max) : TurningSession(params, beams_max) {}
};

}  // namespace odoless
