#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/log/byte_stream.hpp"

namespace odoless {

/// A message of an LCM log.
struct LoggedMessage {
  std::int64_t number = 0;
  std::int64_t time_us = 0;
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Reads an LCM log (lcm-logger's, odolessd's recorder's), message by message. liblcm's own reader looks for the next
/// message for ever, and takes as much memory as a message claims to need; this one trusts nothing.
class EventLog {
 public:
  /// More bytes between two messages are no damage any more: it is another kind of file.
  static constexpr std::size_t kSkippedBytesMax = std::size_t{1} << 20;
  static constexpr std::int32_t kDataBytesMax = std::int32_t{1} << 26;

  /// `name` stands in messages.
  EventLog(std::unique_ptr<ByteStream> bytes, std::string name);

  /// The next message; false at the end, which may lie within one, where its writer was killed.
  /// @throws DataError where it is no LCM log, or too much of it is damaged; what ByteStream::read throws.
  [[nodiscard]] bool next(LoggedMessage& message);

  /// How many bytes up to here belong to no whole message.
  [[nodiscard]] std::size_t lost_bytes() const { return lost_bytes_; }

 private:
  [[nodiscard]] bool find_message();
  /// False at the end.
  [[nodiscard]] bool read(std::span<char> out);
  template <class Bytes>
  [[nodiscard]] bool read_many(Bytes& out, std::size_t size);
  [[noreturn]] void fail(const std::string& wrong) const;

  std::unique_ptr<ByteStream> bytes_;
  std::string name_;
  std::size_t lost_bytes_ = 0;
};

}  // namespace odoless
