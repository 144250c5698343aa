#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "tools/log/byte_stream.hpp"

namespace odoless {

/// Pieces of a binary file, in order. Memory follows what the file holds, never what a count in it claims.
class BinaryStream {
 public:
  /// No message with a scan is longer.
  static constexpr std::uint64_t kPieceBytesMax = std::uint64_t{1} << 26U;

  /// `name` stands in messages.
  BinaryStream(std::unique_ptr<ByteStream> bytes, std::string name);

  [[nodiscard]] bool at_end();

  /// The next `size` bytes, valid until the next call.
  /// @throws DataError where the file ends before them, or they are more than kPieceBytesMax.
  [[nodiscard]] std::string_view take(std::uint64_t size_bytes);

  /// Up to `size` of the next bytes, fewer at the end, which stay the next ones.
  [[nodiscard]] std::string_view peek(std::size_t size_bytes);

  /// @throws DataError where the file ends before.
  void skip(std::uint64_t size_bytes);

  /// The next `size` bytes as a stream of their own, to be read to its end before anything else is; it lives no longer
  /// than this one.
  [[nodiscard]] std::unique_ptr<ByteStream> slice(std::uint64_t size_bytes);

  /// How many bytes have been taken or skipped.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// @throws DataError that says where.
  [[noreturn]] void fail(const std::string& wrong, const std::string& right) const;

 private:
  friend class SliceStream;
  [[nodiscard]] std::string_view rest() const { return std::string_view(buffer_).substr(begin_); }
  [[nodiscard]] bool refill();
  void advance(std::size_t size_bytes);
  [[noreturn]] void fail_cut() const;

  std::unique_ptr<ByteStream> bytes_;
  std::string name_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of the part of buffer_ that has not been given out
  std::uint64_t position_ = 0;
};

}  // namespace odoless
