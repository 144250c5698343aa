#pragma once

#include <memory>
#include <string>

#include "core/base/result.hpp"
#include "drivers/io/device_address.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "drivers/io/name_lookup.hpp"
#include "drivers/io/usb_serial.hpp"

namespace odoless {

/// A device's line, opened by the kind of its address, again and again: a serial line, a TCP connection,
/// datagrams of UDP, or a USB device without the kernel's driver. Whichever it is, it is a descriptor that is read and
/// written without blocking, and of which the end is told by 0 bytes or an error.
///
/// Thread: one ordinary thread opens; the descriptors may be used by another, in real time.
class DeviceLine {
 public:
  /// @param address  As parse_device_address has it.
  /// @param baud     Rate of a serial line; 0 leaves it alone. The other kinds have none.
  DeviceLine(std::string address, int baud) : text_(std::move(address)), baud_(baud) {}

  /// The descriptor opened before must be closed by then. Errors: those of open_serial, open_tcp, open_udp and
  /// UsbSerial::open,
  /// and Errc::kBadAddress.
  /// @param priority  Of the thread that USB needs.
  [[nodiscard]] Result<FileDescriptor> open(int priority = 0);

 private:
  [[nodiscard]] Result<FileDescriptor> open_host(const TcpAddress& address);

  std::string text_;
  int baud_;
  NameLookup lookup_;
  std::unique_ptr<UsbSerial> usb_;
};

}  // namespace odoless
