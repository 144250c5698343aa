#pragma once

#include "drivers/tilt/tilt_session.hpp"
#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// What the log says of something that a servo's session told: what is wrong and, where that is known, what would be
/// right. Real time.
struct TiltEventText {
  EventPriority priority = EventPriority::kInfo;
  EventText text;
  std::int64_t number = 0;  ///< in the text
};

[[nodiscard]] TiltEventText text_of(const TiltEvent& event);

}  // namespace odoless
