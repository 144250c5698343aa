#include "tools/log/formats/chunk.hpp"

#include <fmt/core.h>
#include <zlib.h>

#include "tools/command/error.hpp"
#include "tools/log/printable.hpp"
#include "tools/log/unpack.hpp"

namespace odoless {
namespace {

/// Counts and sums what goes through, and compares it with what was said before.
class CheckedStream : public ByteStream {
 public:
  CheckedStream(std::unique_ptr<ByteStream> bytes, std::string name, const ChunkHead& head)
      : bytes_(std::move(bytes)), name_(std::move(name)), left_bytes_(head.unpacked_bytes), crc32_(head.crc32) {}

  std::size_t read(std::span<char> buffer) override {
    const std::size_t got = bytes_->read(buffer);
    if (got > left_bytes_ || (got == 0 && left_bytes_ > 0)) {
      throw DataError(name_, 0, "it holds more or fewer bytes than it says", "a whole file");
    }
    left_bytes_ -= got;
    sum_ = crc32(sum_, reinterpret_cast<const Bytef*>(buffer.data()), static_cast<uInt>(got));
    if (got == 0 && crc32_ != 0 && sum_ != crc32_) {
      throw DataError(name_, 0, "its checksum is wrong", "an undamaged file");
    }
    return got;
  }

 private:
  std::unique_ptr<ByteStream> bytes_;
  std::string name_;
  std::uint64_t left_bytes_;
  std::uint32_t crc32_;
  unsigned long sum_ = 0;
};

std::unique_ptr<ByteStream> unpacked(BinaryStream& whole, const ChunkHead& head, const std::string& name) {
  std::unique_ptr<ByteStream> packed = whole.slice(head.packed_bytes);
  if (head.packing.empty() || head.packing == "none") {
    return packed;
  }
  if (head.packing == "bz2") {
    return unpack_bzip2(std::move(packed), name);
  }
  if (head.packing == "lz4") {
    return unpack_lz4(std::move(packed), name);
  }
  if (head.packing == "zstd") {
    return unpack_zstd(std::move(packed), name);
  }
  whole.fail(fmt::format("a chunk is packed by \"{}\"", printable(head.packing)), "none, bz2, lz4 or zstd");
}

}  // namespace

std::unique_ptr<BinaryStream> open_chunk(BinaryStream& whole, const ChunkHead& head) {
  const std::string name = fmt::format("{}: chunk at byte {}", whole.name(), whole.position());
  return std::make_unique<BinaryStream>(std::make_unique<CheckedStream>(unpacked(whole, head, name), name, head), name);
}

}  // namespace odoless
