#pragma once

#include "drivers/lrf/ldrobot/bring_up.hpp"
#include "drivers/lrf/ldrobot/scan_stream.hpp"
#include "drivers/lrf/turning_session.hpp"

namespace odoless {

/// LDROBOT LD06, LD19 and STL-27L: listens to the stream, which comes unasked, makes scans of evenly spaced beams from
/// its points, and finds it again when it stalls. It sends nothing.
///
/// One damaged byte costs at most the twelve points of its packet. Contract: see LrfSession.
class LdrobotSession final : public TurningSession<ldrobot::ScanStream, ldrobot::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; more in `params` are refused with Errc::kTooManyBeams.
  LdrobotSession(const LrfParams& params, int beams_max) : TurningSession(params, beams_max) {}
};

}  // namespace odoless
