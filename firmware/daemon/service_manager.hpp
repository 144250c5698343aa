#pragma once

#include <string_view>

namespace odoless {

/// Tells the service manager, where there is one, e.g. "READY=1" or "WATCHDOG=1" (sd_notify(3)). One datagram to the
/// socket that NOTIFY_SOCKET names; without that variable, or where
/// nobody reads there, nothing. Thread: any ordinary one.
void notify_service_manager(std::string_view message);

}  // namespace odoless
