#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "tools/log/binary_stream.hpp"

namespace odoless {

/// What a record says of the chunk of messages in it.
struct ChunkHead {
  std::string packing;  ///< empty or "none", or bz2, lz4, zstd
  std::uint64_t packed_bytes = 0;
  std::uint64_t unpacked_bytes = 0;
  std::uint32_t crc32 = 0;  ///< of what is unpacked; 0: unknown
};

/// What is in a chunk that begins at `whole`'s place. It is unpacked as it is read, and must be read to its end before
/// `whole` is; that it is complete is checked there.
/// @throws DataError for a packing that is not known.
[[nodiscard]] std::unique_ptr<BinaryStream> open_chunk(BinaryStream& whole, const ChunkHead& head);

}  // namespace odoless
