#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// How a device's line came to its end.
enum class LineEnd : std::uint8_t {
  kClosed,       ///< the device has closed the connection
  kReset,        ///< the device doesn't know the connection any more, or broke it off
  kTimedOut,     ///< nothing comes back from its network address
  kUnreachable,  ///< there is no way there any more
  kUnplugged,    ///< a serial or USB line that isn't there any more
  kFailed,       ///< another error
};

/// What a read tells that has got no bytes.
/// @param error_number  errno of a read that failed; 0: it read 0 bytes.
[[nodiscard]] LineEnd line_end_of(bool is_tcp, int error_number);

/// What the log says of it; the number is errno. Real time.
[[nodiscard]] EventText laser_line_text(LineEnd end);

}  // namespace odoless
