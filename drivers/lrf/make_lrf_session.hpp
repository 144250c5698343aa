#pragma once

#include <memory>

#include "drivers/io/serial_port.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

/// The session of the laser that `params` name. @param beams_max  Most beams of a scan; memory is set aside for them.
[[nodiscard]] std::unique_ptr<LrfSession> make_lrf_session(const LrfParams& params, int beams_max);

/// Opens the laser's line; errors and contract of open_serial.
[[nodiscard]] Result<FileDescriptor> open_lrf_line(const LrfParams& params);

}  // namespace odoless
