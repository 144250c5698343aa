#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/result.hpp"

namespace odoless {

/// One short message of LCM's UDP protocol; views into the datagram.
struct Datagram {
  std::uint32_t sequence = 0;  ///< counts what one sender sends, whatever the channel
  std::string_view channel{};
  std::span<const std::byte> payload{};
};

/// Takes a datagram apart: "LC02", sequence number, channel up to a zero byte, payload.
///
/// Real time: no allocation, no system call; linear in the channel's name.
/// @return Errc::kTooLong for a piece of a message that is longer than a datagram: such messages are not put together
///         here; Errc::kMalformed for anything else that is no short message, with a channel that is empty, longer than
///         `kChannelMaxBytes` or not ended.
[[nodiscard]] Result<Datagram> parse_datagram(std::span<const std::byte> bytes);

/// The sequence number of a whole message or of a piece of one; Errc::kMalformed if it is neither.
[[nodiscard]] Result<std::uint32_t> datagram_sequence(std::span<const std::byte> bytes);

}  // namespace odoless
