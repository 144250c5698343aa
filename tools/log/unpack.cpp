#include "tools/log/unpack.hpp"

#define ZLIB_CONST  // input is const
#include <lzma.h>
#include <zlib.h>

#include <array>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{64} * 1024;
constexpr std::uint64_t kDecoderBytesMax = 128ULL << 20U;

// Both libraries want unsigned bytes where files have characters.
std::uint8_t* as_bytes(char* characters) {
  return reinterpret_cast<std::uint8_t*>(characters);  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast): see above
}
const std::uint8_t* as_bytes(const char* characters) {
  return reinterpret_cast<const std::uint8_t*>(characters);  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
}

/// The packed side that both decoders share.
class PackedInput {
 public:
  PackedInput(std::unique_ptr<ByteStream> packed, std::string name)
      : packed_(std::move(packed)), name_(std::move(name)) {}

  /// The next chunk; empty at the end.
  std::span<const char> next() { return std::span(chunk_).first(packed_->read(chunk_)); }

  [[noreturn]] void fail_cut() const {
    throw DataError(name_, 0, "the compressed stream ends too early", "a complete .gz or .xz file (is it cut?)");
  }
  [[noreturn]] void fail_damaged() const {
    throw DataError(name_, 0, "the compressed stream is damaged", "a file that `gzip -t` or `xz -t` accepts");
  }

 private:
  std::unique_ptr<ByteStream> packed_;
  std::string name_;
  std::array<char, kChunkBytes> chunk_{};
};

class GzipStream : public ByteStream {
 public:
  GzipStream(std::unique_ptr<ByteStream> packed, const std::string& name) : input_(std::move(packed), name) {
    constexpr int kGzipOnly = 16 + MAX_WBITS;
    if (inflateInit2(&state_, kGzipOnly) != Z_OK) {
      input_.fail_damaged();
    }
  }
  GzipStream(const GzipStream&) = delete;
  GzipStream(GzipStream&&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;
  GzipStream& operator=(GzipStream&&) = delete;
  ~GzipStream() override { inflateEnd(&state_); }

  std::size_t read(std::span<char> buffer) override {
    state_.next_out = as_bytes(buffer.data());
    state_.avail_out = static_cast<uInt>(buffer.size());
    while (state_.avail_out == buffer.size() && !buffer.empty()) {
      if (state_.avail_in == 0 && !refill()) {
        break;
      }
      step();
    }
    return buffer.size() - state_.avail_out;
  }

 private:
  bool refill() {
    const std::span<const char> chunk = input_.next();
    if (chunk.empty() && inside_member_) {
      input_.fail_cut();
    }
    state_.next_in = as_bytes(chunk.data());
    state_.avail_in = static_cast<uInt>(chunk.size());
    return !chunk.empty();
  }

  void step() {
    if (!inside_member_) {
      inflateReset(&state_);
      inside_member_ = true;
    }
    const int status = inflate(&state_, Z_NO_FLUSH);
    if (status == Z_STREAM_END) {
      inside_member_ = false;
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      input_.fail_damaged();
    }
  }

  PackedInput input_;
  z_stream state_{};
  bool inside_member_ = true;
};

class XzStream : public ByteStream {
 public:
  XzStream(std::unique_ptr<ByteStream> packed, const std::string& name) : input_(std::move(packed), name) {
    if (lzma_stream_decoder(&state_, kDecoderBytesMax, LZMA_CONCATENATED) != LZMA_OK) {
      input_.fail_damaged();
    }
  }
  XzStream(const XzStream&) = delete;
  XzStream(XzStream&&) = delete;
  XzStream& operator=(const XzStream&) = delete;
  XzStream& operator=(XzStream&&) = delete;
  ~XzStream() override { lzma_end(&state_); }

  std::size_t read(std::span<char> buffer) override {
    state_.next_out = as_bytes(buffer.data());
    state_.avail_out = buffer.size();
    while (state_.avail_out == buffer.size() && !buffer.empty() && !ended_) {
      if (state_.avail_in == 0 && !input_ended_) {
        refill();
      }
      step();
    }
    return buffer.size() - state_.avail_out;
  }

 private:
  void refill() {
    const std::span<const char> chunk = input_.next();
    state_.next_in = as_bytes(chunk.data());
    state_.avail_in = chunk.size();
    input_ended_ = chunk.empty();
  }

  void step() {
    const lzma_ret status = lzma_code(&state_, input_ended_ ? LZMA_FINISH : LZMA_RUN);
    if (status == LZMA_STREAM_END) {
      ended_ = true;
    } else if (status == LZMA_BUF_ERROR) {
      input_.fail_cut();
    } else if (status != LZMA_OK) {
      input_.fail_damaged();
    }
  }

  PackedInput input_;
  lzma_stream state_ = LZMA_STREAM_INIT;
  bool input_ended_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<ByteStream> unpack_gzip(std::unique_ptr<ByteStream> packed, const std::string& name) {
  return std::make_unique<GzipStream>(std::move(packed), name);
}

std::unique_ptr<ByteStream> unpack_xz(std::unique_ptr<ByteStream> packed, const std::string& name) {
  return std::make_unique<XzStream>(std::move(packed), name);
}

}  // namespace odoless
