#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace odoless {

/// What the two halves of a daemon share, and nobody else knows.
using LcmKey = std::array<std::byte, 32>;

/// A key as text: 64 hexadecimal digits and at most one line feed behind them.
[[nodiscard]] std::optional<LcmKey> parse_key(std::string_view text);

/// Reads a key from a file that only its owner may write to, and that is not for everybody to read. Errc::kBadAddress;
/// `reason` then says what is wrong and what would be right.
[[nodiscard]] Result<LcmKey> read_key(const std::string& path, std::string& reason);

/// HMAC-SHA-256 (RFC 2104) under one key. Real time after construction: no allocation, no lock; linear in the message.
class Hmac {
 public:
  using Tag = std::array<std::byte, 32>;

  explicit Hmac(const LcmKey& key);
  ~Hmac();
  Hmac(Hmac&&) noexcept;
  Hmac& operator=(Hmac&&) noexcept;
  Hmac(const Hmac&) = delete;
  Hmac& operator=(const Hmac&) = delete;

  /// Of the pieces one behind the other.
  [[nodiscard]] Tag of(std::span<const std::span<const std::byte>> pieces) const;

 private:
  struct States;
  std::unique_ptr<States> states_;  ///< of SHA-256, with the key taken in
};

/// An authenticated message is the message, as it would be without a key, and behind it a trailer in LCM's byte order:
///
///     "ODA1" | sequence (8) | utime of sending (8, microseconds since 1970) | HMAC-SHA-256 (32)
///
/// The HMAC is over the channel's name, a zero byte, the message, and the trailer up to it. Each message has a higher
/// sequence than all before of that key: the time of sending in microseconds, or one more than the last where the clock
/// is not past that, so that this holds from one start of a sender to the next.
inline constexpr std::size_t kTrailerBytes = 4 + 8 + 8 + 32;

/// Makes trailers. One sender to a key: the sequences of two would get mixed up.
class MessageSigner {
 public:
  explicit MessageSigner(const LcmKey& key) : hmac_(key) {}

  /// The next one, of a message that is sent now.
  [[nodiscard]] std::array<std::byte, kTrailerBytes> sign(std::string_view channel, std::span<const std::byte> message,
                                                          std::int64_t now_us);

 private:
  Hmac hmac_;
  std::uint64_t last_sequence_ = 0;
};

/// Gives messages without their trailers, and refuses those that are not of who has the key, or not of now.
///
/// Real time: no allocation, no system call; linear in the message. Thread: one thread.
class MessageVerifier {
 public:
  /// A message that has been on its way, or that was kept by somebody, for longer is refused: so far the clocks of two
  /// hosts may differ.
  static constexpr std::int64_t kAgeMax_us = 5'000'000;

  explicit MessageVerifier(const LcmKey& key) : hmac_(key) {}

  /// @param payload  As received: anybody may have made it.
  /// @return Errc::kMalformed without a trailer; Errc::kWrongSum if the HMAC is not that of the message on this
  ///         channel; Errc::kTooOld if the message was taken before, is older than one that was, or was not sent within
  ///         `kAgeMax_us` of `now_us`. What is refused leaves no trace.
  [[nodiscard]] Result<std::span<const std::byte>> verify(std::string_view channel, std::span<const std::byte> payload,
                                                          std::int64_t now_us);

 private:
  Hmac hmac_;
  std::uint64_t last_sequence_ = 0;
};

/// The wall clock.
[[nodiscard]] std::int64_t wall_clock_us();

}  // namespace odoless
