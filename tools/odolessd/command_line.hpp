#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace odoless {

/// Shows `reader` the daemon's options, for its manual page.
void describe_odolessd(const std::function<void(const CLI::App&)>& reader);

/// The daemon's command line. @return  Exit status of sysexits.h; what is wrong stands on standard error.
[[nodiscard]] int run_odolessd(int argc, const char* const* argv);

}  // namespace odoless
