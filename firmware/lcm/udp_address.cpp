#include "firmware/lcm/udp_address.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <charconv>
#include <limits>
#include <optional>
#include <string>

namespace odoless {
namespace {

std::optional<int> whole_number(std::string_view text, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 1 || value > max) {
    return std::nullopt;
  }
  return value;
}

std::optional<std::uint32_t> multicast_group(std::string_view text) {
  in_addr address{};
  if (inet_pton(AF_INET, std::string(text).c_str(), &address) != 1 || !IN_MULTICAST(ntohl(address.s_addr))) {
    return std::nullopt;
  }
  return ntohl(address.s_addr);
}

}  // namespace

Result<MulticastAddress> parse_udp_address(std::string_view url) {
  constexpr std::string_view kScheme = "udpm://";
  constexpr std::string_view kBuffer = "recv_buf_size=";
  if (!url.starts_with(kScheme)) {
    return Errc::kBadAddress;
  }
  url.remove_prefix(kScheme.size());
  const std::string_view place = url.substr(0, url.find('?'));
  const std::string_view option = place.size() < url.size() ? url.substr(place.size() + 1) : std::string_view{};
  const std::size_t colon = place.find(':');
  if (colon == std::string_view::npos) {
    return Errc::kBadAddress;
  }
  const auto group = multicast_group(place.substr(0, colon));
  const auto port = whole_number(place.substr(colon + 1), std::numeric_limits<std::uint16_t>::max());
  if (!group || !port) {
    return Errc::kBadAddress;
  }
  MulticastAddress address{.group = *group, .port = static_cast<std::uint16_t>(*port)};
  if (!option.empty()) {
    const auto bytes = option.starts_with(kBuffer)
                           ? whole_number(option.substr(kBuffer.size()), std::numeric_limits<int>::max())
                           : std::nullopt;
    if (!bytes) {
      return Errc::kBadAddress;
    }
    address.receive_buffer_bytes = *bytes;
  }
  return address;
}

}  // namespace odoless
