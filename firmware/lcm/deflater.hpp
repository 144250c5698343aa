#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/result.hpp"

namespace odoless {

/// Compresses blocks of bytes, each by itself, to the zlib format (RFC 1950).
///
/// All memory is taken at construction. Thread: one at a time; not for a real-time thread.
class Deflater {
 public:
  Deflater();
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  /// Bytes written to `out`, or Errc::kTooLong if they don't fit. Does not allocate.
  [[nodiscard]] Result<std::size_t> deflate(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace odoless
