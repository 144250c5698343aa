#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tools/log/byte_stream.hpp"

namespace odoless {

/// Lines of a text, counted from 1. A line is at most 1 MiB, there are at most `kLinesMax`, and of all together at most
/// `kKeptBytesMax` is kept, so that a hostile file cannot take all memory: 1.5 MB of xz may hold 10 GB of text.
///
/// The text is ASCII or UTF-8, with or without a byte order mark; UTF-16 is refused.
class LineReader {
 public:
  static constexpr int kLinesMax = 100'000'000;
  static constexpr std::size_t kKeptBytesMax = std::size_t{1} << 30;

  /// `name` stands in messages.
  LineReader(std::unique_ptr<ByteStream> bytes, std::string name, std::size_t kept_bytes_max = kKeptBytesMax);

  /// The next line without its end (LF or CR LF); valid until the next call. False at the end.
  /// @throws DataError for a line that is too long or one too many, for another encoding, and what ByteStream::read
  ///         throws.
  [[nodiscard]] bool next(std::string_view& line);

  /// Whoever keeps something of the last line says how much.
  /// @throws DataError when that is too much in all.
  void keep(std::size_t bytes);

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void skip_mark();
  [[nodiscard]] bool refill();
  [[nodiscard]] std::string_view take(std::size_t length, std::size_t skip);

  std::unique_ptr<ByteStream> bytes_;
  std::string name_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of the part of buffer_ that has not been given out
  std::size_t kept_bytes_max_;
  std::size_t kept_bytes_ = 0;
  int number_ = 0;
};

}  // namespace odoless
