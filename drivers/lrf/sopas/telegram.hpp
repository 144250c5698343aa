#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace odoless::sopas {

/// The two forms in which a SOPAS device speaks.
enum class Dialect : std::uint8_t {
  kAscii,   ///< CoLa A: 02h, text, 03h; without a check sum
  kBinary,  ///< CoLa B: four times 02h, length, content, XOR of the content
};

/// Takes the values of a telegram one after the other. What is not there, or cannot be, is 0, and `ok` is false from
/// then on.
class Fields {
 public:
  Fields(Dialect dialect, std::string_view rest) : dialect_(dialect), rest_(rest) {}

  /// A number of so many bytes, which ASCII has in hexadecimal digits, or in decimal ones after a sign.
  [[nodiscard]] std::uint32_t number(int bytes);
  [[nodiscard]] std::int32_t signed_number() { return static_cast<std::int32_t>(number(4)); }
  /// IEEE 754, of 4 bytes or 8 hexadecimal digits.
  [[nodiscard]] float real();
  /// A text of that length, without a space.
  [[nodiscard]] std::string_view text(std::size_t size_bytes);

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool empty() const { return rest_.empty(); }
  /// What is left: words, or bytes.
  [[nodiscard]] std::size_t left() const;

 private:
  [[nodiscard]] std::string_view take(std::size_t size_bytes);
  [[nodiscard]] std::string_view word();
  [[nodiscard]] std::uint32_t fail();

  Dialect dialect_;
  std::string_view rest_;
  bool ok_ = true;
};

/// What one telegram says; a view, valid until the reader's next call.
struct Telegram {
  Dialect dialect = Dialect::kAscii;
  std::string_view content;  ///< "sRA LMPscancfg " and its values

  /// "sRA"
  [[nodiscard]] std::string_view command() const { return content.substr(0, 3); }
  /// "LMPscancfg"; "sFA" has none.
  [[nodiscard]] std::string_view name() const;
  [[nodiscard]] Fields fields() const;
  /// Whether the device refuses what it was asked.
  [[nodiscard]] bool is_refusal() const { return command() == "sFA"; }
  /// Of a refusal; -1: it says none.
  [[nodiscard]] int refusal_code() const;
};

/// A telegram that is being written, of at most 128 bytes.
class Request {
 public:
  Request() = default;
  /// @param head  Command and name: "sRN LMPscancfg".
  Request(Dialect dialect, std::string_view head);
  /// A number of so many bytes; ASCII: with that many digits at least.
  Request& number(std::uint32_t value, int bytes, int digits = 1);
  /// As it is sent.
  [[nodiscard]] std::span<const std::byte> finish();

 private:
  void put(char c) { bytes_[size_++] = c; }

  static constexpr std::size_t kHeadBytes = 8;  ///< of the binary form
  Dialect dialect_ = Dialect::kAscii;
  bool has_values_ = false;
  std::array<char, 160> bytes_{};
  std::size_t size_ = 0;
};

/// Cuts received bytes into telegrams, of whichever dialect they are.
///
/// After damage it looks for the next start among the bytes that it has kept, so that a wrong length costs no other
/// telegram. Thread: one thread. Real time: no allocation after construction; a sum is made at most once per 9 bytes.
class TelegramReader {
 public:
  enum class Outcome : std::uint8_t {
    kMore,      ///< all bytes are used, and no telegram is complete
    kTelegram,  ///< `telegram` is complete
    kSkipped,   ///< bytes were thrown away up to what looks like a start
    kWrongSum,  ///< what looked like a telegram has the wrong sum
  };

  explicit TelegramReader(std::size_t content_max_bytes) : bytes_(content_max_bytes + kFrameBytes) { clear(); }

  /// Takes bytes off the front of `bytes`, up to the end of a telegram.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes);
  [[nodiscard]] const Telegram& telegram() const { return telegram_; }

  /// No telegram is longer from now on; `clear` lifts it.
  void set_limit(std::size_t content_bytes);
  /// Forgets what was received.
  void clear();

 private:
  static constexpr std::size_t kFrameBytes = 9;  ///< around the content, at most

  [[nodiscard]] std::string_view kept() const { return {bytes_.data() + begin_, end_ - begin_}; }
  [[nodiscard]] Outcome inspect();
  [[nodiscard]] Outcome inspect_ascii(std::string_view have);
  [[nodiscard]] Outcome inspect_binary(std::string_view have);
  [[nodiscard]] Outcome found(Dialect dialect, std::string_view content, std::size_t frame_bytes);
  /// To the next byte that may be a start.
  [[nodiscard]] Outcome skip(Outcome outcome);

  std::vector<char> bytes_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t seen_ = 0;        ///< of a telegram in ASCII: looked through
  std::size_t done_bytes_ = 0;  ///< of the telegram that was given out
  std::size_t limit_bytes_ = 0;
  bool is_skipping_ = false;  ///< told already
  Telegram telegram_;
};

}  // namespace odoless::sopas
