#include "tools/log/binary_stream.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "tools/command/error.hpp"

namespace odoless {
namespace {
constexpr std::size_t kRefillBytes = std::size_t{64} * 1024;
}  // namespace

/// A part of a BinaryStream.
class SliceStream : public ByteStream {
 public:
  SliceStream(BinaryStream& whole, std::uint64_t size_bytes) : whole_(whole), left_bytes_(size_bytes) {}

  std::size_t read(std::span<char> buffer) override {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), left_bytes_));
    if (wanted == 0) {
      return 0;
    }
    if (whole_.at_end()) {
      whole_.fail_cut();
    }
    const std::size_t got = whole_.rest().copy(buffer.data(), wanted);
    whole_.advance(got);
    left_bytes_ -= got;
    return got;
  }

 private:
  BinaryStream& whole_;
  std::uint64_t left_bytes_;
};

BinaryStream::BinaryStream(std::unique_ptr<ByteStream> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)) {}

void BinaryStream::fail(const std::string& wrong, const std::string& right) const {
  throw DataError(name_, 0, fmt::format("at byte {}: {}", position_, wrong), right);
}

void BinaryStream::fail_cut() const {
  fail("the file ends within a record",
       "a whole file; what its recorder left unfinished, `rosbag reindex` or `mcap recover` mends");
}

bool BinaryStream::refill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kRefillBytes);
  const std::size_t got = bytes_->read(std::span(buffer_).subspan(kept));
  buffer_.resize(kept + got);
  return got > 0;
}

void BinaryStream::advance(std::size_t size_bytes) {
  begin_ += size_bytes;
  position_ += size_bytes;
}

bool BinaryStream::at_end() { return rest().empty() && !refill(); }

std::string_view BinaryStream::peek(std::size_t size_bytes) {
  while (rest().size() < size_bytes && refill()) {
  }
  return rest().substr(0, size_bytes);
}

std::string_view BinaryStream::take(std::uint64_t size_bytes) {
  if (size_bytes > kPieceBytesMax) {
    fail(fmt::format("a piece of {} bytes", size_bytes), fmt::format("at most {}", kPieceBytesMax));
  }
  const auto size = static_cast<std::size_t>(size_bytes);
  const std::string_view taken = peek(size);
  if (taken.size() < size) {
    fail_cut();
  }
  advance(size);
  return taken;
}

void BinaryStream::skip(std::uint64_t size_bytes) {
  while (size_bytes > 0) {
    if (at_end()) {
      fail_cut();
    }
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(size_bytes, rest().size()));
    advance(part);
    size_bytes -= part;
  }
}

std::unique_ptr<ByteStream> BinaryStream::slice(std::uint64_t size_bytes) {
  return std::make_unique<SliceStream>(*this, size_bytes);
}

}  // namespace odoless
