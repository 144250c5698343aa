#pragma once

namespace odoless {

/// The daemon's command line. @return  Exit status of sysexits.h; what is wrong stands on standard error.
[[nodiscard]] int run_odolessd(int argc, const char* const* argv);

}  // namespace odoless
