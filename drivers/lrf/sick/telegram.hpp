#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.hpp"

namespace odoless::sick {

inline constexpr std::byte kStx{0x02};
inline constexpr std::byte kAck{0x06};
inline constexpr std::byte kNak{0x15};
inline constexpr std::byte kToDevice{0x00};
inline constexpr std::byte kFromDevice{0x80};
inline constexpr std::size_t kHeadBytes = 4;  ///< start, address, length
inline constexpr std::size_t kSumBytes = 2;

/// CRC of the LMS2xx over everything from STX on: polynomial 0x8005, with each byte taken in twice, the second time in
/// the higher half together with its successor.
[[nodiscard]] std::uint16_t checksum(std::span<const std::byte> bytes);

/// Number of two bytes, the lower one first.
[[nodiscard]] constexpr unsigned number(std::byte low, std::byte high) {
  return std::to_integer<unsigned>(low) | (std::to_integer<unsigned>(high) << 8U);
}

/// What one telegram from the device says; a view, valid until the reader's next call.
struct Telegram {
  std::span<const std::byte> payload;  ///< command, data, status

  [[nodiscard]] int command() const { return std::to_integer<int>(payload.front()); }
  [[nodiscard]] std::span<const std::byte> data() const { return payload.subspan(1, payload.size() - 2); }
  [[nodiscard]] int status() const { return std::to_integer<int>(payload.back()); }
};

/// A telegram to the device. @param payload  Command and data, at most 40 bytes.
class Request {
 public:
  Request() = default;
  explicit Request(std::span<const std::byte> payload);
  [[nodiscard]] std::span<const std::byte> bytes() const { return {bytes_.data(), size_}; }

 private:
  std::array<std::byte, 46> bytes_{};
  std::size_t size_ = 0;
};

/// Cuts received bytes into telegrams.
///
/// After damage it looks for the next start among the bytes that it has kept, so that a wrong length costs no other
/// telegram. While a stream runs, only the lengths that a scan or a short message has can be.
/// Thread: one thread. Real time: no allocation after construction; a sum is made at most once per two bytes.
class TelegramReader {
 public:
  enum class Outcome {
    kMore,           ///< all bytes are used, and no telegram is complete
    kTelegram,       ///< `telegram` is complete
    kUnderstood,     ///< the device has understood a request
    kNotUnderstood,  ///< the device has not understood a request
    kSkipped,        ///< bytes were thrown away up to what looks like a start
    kWrongSum,       ///< what looked like a telegram has the wrong sum
  };

  explicit TelegramReader(std::size_t payload_max_bytes);

  /// Takes bytes off the front of `bytes`, up to the end of a telegram.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes);
  [[nodiscard]] const Telegram& telegram() const { return telegram_; }

  /// Length of a scan's payload, up to two index bytes more; 0: no stream runs, and every length can be.
  void expect_stream(std::size_t payload_bytes) { stream_payload_bytes_ = payload_bytes; }

  /// Forgets what was received.
  void clear();

 private:
  [[nodiscard]] std::span<const std::byte> rest() const { return std::span(bytes_).subspan(begin_, end_ - begin_); }
  [[nodiscard]] bool can_be_length(std::size_t payload_bytes) const;
  [[nodiscard]] bool can_start() const;
  [[nodiscard]] Outcome inspect();
  [[nodiscard]] Outcome inspect_telegram(std::span<const std::byte> have);
  void make_room();

  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t done_bytes_ = 0;  ///< of the telegram that was given out
  std::size_t stream_payload_bytes_ = 0;
  bool skipping_ = false;  ///< told already
  Telegram telegram_;
};

}  // namespace odoless::sick
