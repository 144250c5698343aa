#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tools/log/byte_stream.hpp"

namespace odoless {

/// Lines of a text, counted from 1. A line is at most 1 MiB, so that a hostile file cannot take all memory.
class LineReader {
 public:
  /// `name` stands in messages.
  LineReader(std::unique_ptr<ByteStream> bytes, std::string name);

  /// The next line without its end (LF or CR LF); valid until the next call. False at the end.
  /// @throws DataError for a line that is too long, and what ByteStream::read throws.
  [[nodiscard]] bool next(std::string_view& line);

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[nodiscard]] bool refill();
  [[nodiscard]] std::string_view take(std::size_t length, std::size_t skip);

  std::unique_ptr<ByteStream> bytes_;
  std::string name_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of the part of buffer_ that has not been given out
  int number_ = 0;
};

}  // namespace odoless
