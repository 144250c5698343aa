#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/result.hpp"

namespace odoless {

/// "/dev/ttyACM0": a path.
struct SerialAddress {
  std::string path;
  friend bool operator==(const SerialAddress&, const SerialAddress&) = default;
};

/// "tcp://192.168.0.10:10940", "tcp://[fe80::1]:10940", "tcp://laser.local:10940".
struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;
  friend bool operator==(const TcpAddress&, const TcpAddress&) = default;
};

/// "usb://15d1:0000" or "usb://15d1:0000/H0000001": vendor, product (hexadecimal) and, where it matters, serial number.
struct UsbAddress {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string serial;  ///< empty: whichever
  friend bool operator==(const UsbAddress&, const UsbAddress&) = default;
};

/// "udp://127.0.0.1:5005": an address of this machine, a number, at which datagrams are waited for.
struct UdpAddress {
  std::string host;
  std::uint16_t port = 0;
  friend bool operator==(const UdpAddress&, const UdpAddress&) = default;
};

/// Where a device is to be found.
using DeviceAddress = std::variant<SerialAddress, TcpAddress, UsbAddress, UdpAddress>;

/// Errors: Errc::kBadAddress.
[[nodiscard]] Result<DeviceAddress> parse_device_address(std::string_view text);

/// Whether that is a serial line of this machine, so that its rate is ours to set; those at the far end of a network or
/// past the kernel's driver aren't.
[[nodiscard]] bool is_serial(std::string_view text);

}  // namespace odoless
