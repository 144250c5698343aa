#pragma once

#include <string>

namespace odoless {

/// Where a daemon takes commands. As configured; but where nothing is configured, and this user may not write to the
/// system's folder, in the user's own: $XDG_RUNTIME_DIR/odoless/control.
[[nodiscard]] std::string socket_to_open(const std::string& configured);

/// Where to ask for a daemon: the user's own, if there is one and nothing is configured.
[[nodiscard]] std::string socket_to_ask(const std::string& configured);

}  // namespace odoless
