#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/result.hpp"

namespace odoless {

/// Group and port of LCM over UDP.
struct MulticastAddress {
  std::uint32_t group = 0;  ///< IPv4 multicast address, the host's byte order
  std::uint16_t port = 0;
  /// Of the socket, 0: the system's default. By itself more than a second of scans in five sendings: the system's own
  /// 208 KiB overflow when a busy host lets a reader wait for 50 ms.
  int receive_buffer_bytes = 4 << 20;
};

/// Reads udpm://GROUP:PORT, with ?recv_buf_size=BYTES or without. Errc::kBadAddress for anything else, and for a group
/// outside 224.0.0.0/4.
[[nodiscard]] Result<MulticastAddress> parse_udp_address(std::string_view url);

}  // namespace odoless
