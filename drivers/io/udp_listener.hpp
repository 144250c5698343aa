#pragma once

#include "core/base/result.hpp"
#include "drivers/io/device_address.hpp"
#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// Listens to datagrams at an address of this machine; each read has one. Empty ones, which would be taken for the
/// line's end, are thrown away by the kernel. Whoever can reach that address can send: 127.0.0.1 is for this machine's
/// programs alone.
///
/// Errors: Errc::kDeviceBusy (another program listens there), kDeviceMissing (no such address here), kDeviceDenied,
/// kDeviceFailed, kBadAddress.
[[nodiscard]] Result<FileDescriptor> open_udp(const UdpAddress& address);

}  // namespace odoless
