#pragma once

#include <cstdint>

#include "core/base/result.hpp"
#include "drivers/io/device_address.hpp"
#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// How long open_tcp waits for the other side.
inline constexpr std::int64_t kConnectTimeout_ns = 300'000'000;

/// Connects to a device: a non-blocking socket that sends at once (no Nagle), and of which a side that is gone without
/// a word is told within about three seconds: what was sent stays unacknowledged, or nothing answers the keep-alive.
///
/// Writing to a connection that the other side has closed raises SIGPIPE, which a program should ignore.
///
/// Errors: Errc::kDeviceMissing (nobody answers, or nobody listens there), kDeviceDenied, kDeviceFailed, kBadAddress.
/// Thread: an ordinary one; it waits for at most `timeout_ns`.
[[nodiscard]] Result<FileDescriptor> open_tcp(const TcpAddress& address, std::int64_t timeout_ns = kConnectTimeout_ns);

}  // namespace odoless
