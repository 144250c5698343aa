#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

namespace odoless {

/// Bytes in order, from wherever they come.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream(ByteStream&&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  ByteStream& operator=(ByteStream&&) = delete;
  virtual ~ByteStream() = default;

  /// Fills `buffer` from its start. Returns the number of bytes, at least 1 but for the end of the stream.
  /// @throws DataError for a compressed stream that is damaged or cut, IoError when the device fails.
  [[nodiscard]] virtual std::size_t read(std::span<char> buffer) = 0;
};

/// A stream whose first bytes have been looked at already.
class PeekedStream : public ByteStream {
 public:
  explicit PeekedStream(std::unique_ptr<ByteStream> rest);

  /// Up to 64 bytes, which `read` gives all the same.
  [[nodiscard]] std::string_view head() const { return {head_.data(), size_}; }

  std::size_t read(std::span<char> buffer) override;

 private:
  std::unique_ptr<ByteStream> rest_;
  std::array<char, 64> head_{};
  std::size_t size_ = 0;
  std::size_t taken_ = 0;
};

/// Opens a file, and unpacks it on the way when its first bytes say gzip, xz, bzip2, LZ4 or Zstandard (the name does
/// not matter).
/// @throws NoInputError when it cannot be opened.
[[nodiscard]] std::unique_ptr<ByteStream> open_bytes(const std::filesystem::path& path);

/// The same for bytes in memory, which must outlive the stream. `name` stands in messages.
[[nodiscard]] std::unique_ptr<ByteStream> view_bytes(std::string_view bytes, const std::string& name);

}  // namespace odoless
