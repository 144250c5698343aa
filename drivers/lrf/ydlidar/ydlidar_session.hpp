#pragma once

#include "drivers/lrf/turning_session.hpp"
#include "drivers/lrf/ydlidar/bring_up.hpp"
#include "drivers/lrf/ydlidar/scan_stream.hpp"

namespace odoless {

/// YDLIDAR X2, X4, G4, TG and their kin: listens to the stream, or starts it, makes scans of evenly spaced beams from
/// its points, and finds it again when it stalls.
///
/// One damaged byte costs at most the samples of its packet. Contract: see LrfSession.
class YdlidarSession final : public TurningSession<ydlidar::ScanStream, ydlidar::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; more in `params` are refused with Errc::kTooManyBeams.
  YdlidarSession(const LrfParams& params, int beams_max) : TurningSession(params, beams_max) {}
};

}  // namespace odoless
