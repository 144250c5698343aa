#include "drivers/io/device_address.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>

namespace odoless {
namespace {

/// The whole of `text` as a number, with no sign and no prefix.
std::optional<std::uint16_t> parse_number(std::string_view text, int base) {
  std::uint32_t number = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, number, base);
  if (error != std::errc() || end != text_end || number > std::numeric_limits<std::uint16_t>::max()) {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(number);
}

bool is_numeric_host(const std::string& host) {
  std::array<std::byte, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

/// RFC 1123; a name that ends in a number would be a wrong IPv4 address.
bool is_host_name(std::string_view host) {
  constexpr std::size_t kLongest = 253;
  const auto is_of_name = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
  };
  const std::string_view last_label = host.substr(host.rfind('.') + 1);
  return !host.empty() && host.size() <= kLongest && std::all_of(host.begin(), host.end(), is_of_name) &&
         host.front() != '-' && host.front() != '.' && host.find("..") == std::string_view::npos &&
         last_label.find_first_not_of("0123456789") != std::string_view::npos;
}

Result<DeviceAddress> parse_tcp(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) {
    return Errc::kBadAddress;
  }
  std::string_view host = text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  const std::optional<std::uint16_t> port = parse_number(text.substr(colon + 1), 10);
  TcpAddress address{.host = std::string(host), .port = port.value_or(0)};
  if (address.port == 0 || !(is_numeric_host(address.host) || is_host_name(address.host))) {
    return Errc::kBadAddress;
  }
  return DeviceAddress(std::move(address));
}

Result<DeviceAddress> parse_udp(std::string_view text) {
  const Result<DeviceAddress> parsed = parse_tcp(text);
  if (!parsed.ok()) {
    return parsed.error();
  }
  const auto& address = std::get<TcpAddress>(parsed.value());
  return is_numeric_host(address.host) ? Result<DeviceAddress>(UdpAddress{address.host, address.port})
                                       : Result<DeviceAddress>(Errc::kBadAddress);
}

Result<DeviceAddress> parse_usb(std::string_view text) {
  const std::size_t slash = text.find('/');
  const std::string_view numbers = text.substr(0, slash);
  const std::size_t colon = numbers.find(':');
  if (colon == std::string_view::npos || slash + 1 == text.size()) {
    return Errc::kBadAddress;
  }
  const std::optional<std::uint16_t> vendor = parse_number(numbers.substr(0, colon), 16);
  const std::optional<std::uint16_t> product = parse_number(numbers.substr(colon + 1), 16);
  if (!vendor || !product) {
    return Errc::kBadAddress;
  }
  const std::string_view serial = slash == std::string_view::npos ? std::string_view() : text.substr(slash + 1);
  return DeviceAddress(UsbAddress{.vendor = *vendor, .product = *product, .serial = std::string(serial)});
}

}  // namespace

Result<DeviceAddress> parse_device_address(std::string_view text) {
  constexpr std::string_view kTcp = "tcp://";
  constexpr std::string_view kUsb = "usb://";
  constexpr std::string_view kUdp = "udp://";
  if (text.starts_with(kTcp)) {
    return parse_tcp(text.substr(kTcp.size()));
  }
  if (text.starts_with(kUsb)) {
    return parse_usb(text.substr(kUsb.size()));
  }
  if (text.starts_with(kUdp)) {
    return parse_udp(text.substr(kUdp.size()));
  }
  if (text.empty() || text.find("://") != std::string_view::npos) {
    return Errc::kBadAddress;
  }
  return DeviceAddress(SerialAddress{.path = std::string(text)});
}

bool is_serial(std::string_view text) {
  const Result<DeviceAddress> address = parse_device_address(text);
  return address.ok() && std::holds_alternative<SerialAddress>(address.value());
}

}  // namespace odoless
