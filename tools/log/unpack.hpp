#pragma once

#include <memory>
#include <string>

#include "tools/log/byte_stream.hpp"

namespace odoless {

/// Unpacks gzip (one or more members). `name` stands in messages. Reading throws DataError when it is damaged or cut.
[[nodiscard]] std::unique_ptr<ByteStream> unpack_gzip(std::unique_ptr<ByteStream> packed, const std::string& name);

/// Unpacks xz (one or more streams), with at most 128 MiB for the decoder. Errors as for gzip.
[[nodiscard]] std::unique_ptr<ByteStream> unpack_xz(std::unique_ptr<ByteStream> packed, const std::string& name);

/// Unpacks bzip2, LZ4 frames and Zstandard (one or more streams or frames), as chunks of recorded messages are packed.
/// Errors as for gzip.
[[nodiscard]] std::unique_ptr<ByteStream> unpack_bzip2(std::unique_ptr<ByteStream> packed, const std::string& name);
[[nodiscard]] std::unique_ptr<ByteStream> unpack_lz4(std::unique_ptr<ByteStream> packed, const std::string& name);
[[nodiscard]] std::unique_ptr<ByteStream> unpack_zstd(std::unique_ptr<ByteStream> packed, const std::string& name);

}  // namespace odoless
