#pragma once

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

/// Opens a file, and unpacks it on the way when its first bytes say gzip or xz (the name does not matter).
/// @throws NoInputError when it cannot be opened.
[[nodiscard]] std::unique_ptr<ByteStream> open_bytes(const std::filesystem::path& path);

/// The same for bytes in memory, which must outlive the stream. `name` stands in messages.
[[nodiscard]] std::unique_ptr<ByteStream> view_bytes(std::string_view bytes, const std::string& name);

}  // namespace odoless
