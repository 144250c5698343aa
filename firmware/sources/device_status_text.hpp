#pragma once

#include "drivers/lrf/lrf_params.hpp"
#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// What the log says of an error that a laser reports (LrfEvent::device_status), which is the text's number. Real time.
[[nodiscard]] EventText device_status_text(LrfDriver driver, int device_status);

}  // namespace odoless
