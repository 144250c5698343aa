#pragma once

#include <string>

#include "core/base/result.hpp"
#include "drivers/io/file_descriptor.hpp"

namespace odoless {

struct SerialParams {
  std::string path;
  int baud = 0;  ///< any rate that the hardware can do; 0 leaves the rate alone (USB and pseudo-terminals have none)
};

/// Opens a serial line raw (8N1, no flow control, no echo), non-blocking and for this process alone, and throws away
/// what it received before. Another process that uses open_serial is refused whoever runs it.
///
/// Errors: Errc::kDeviceMissing, kDeviceBusy (in use by another process), kDeviceDenied (permissions), kNotSerial (the
/// path is no terminal), kBaudRefused, kDeviceFailed.
/// Thread: an ordinary one; it makes system calls and may wait for the device.
[[nodiscard]] Result<FileDescriptor> open_serial(const SerialParams& params);

/// Changes the rate of an open line. Errors: Errc::kBaudRefused: the line has none, or cannot have that one, and then
/// has whichever its driver chose. Real time: three system calls, no allocation.
[[nodiscard]] Errc set_serial_baud(int descriptor, int baud);

/// Whether two ends of a line at these rates understand each other: their bits run less than 3 % apart.
[[nodiscard]] bool baud_fits(int wanted_baud, int had_baud);

/// The rate of an open line; 0: it has none. Real time: one system call, no allocation.
[[nodiscard]] int serial_baud(int descriptor);

}  // namespace odoless
