#pragma once

namespace odoless {

/// Runs `odoless` with these arguments and returns its exit status: 0, or one of sysexits.h with the reason on stderr.
[[nodiscard]] int run_command_line(int argc, const char* const* argv);

}  // namespace odoless
