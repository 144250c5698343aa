#pragma once

#include <memory>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

/// The session of the laser that `params` name. @param beams_max  Most beams of a scan; memory is set aside for them.
[[nodiscard]] std::unique_ptr<LrfSession> make_lrf_session(const LrfParams& params, int beams_max);

/// Does to a line that was opened what the laser wants of it besides its rate. Not for a real-time thread.
void set_up_lrf_line(const LrfParams& params, int descriptor);

}  // namespace odoless
