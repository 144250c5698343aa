#include "tools/log/unpack.hpp"

#include <cstdint>

#define ZLIB_CONST  // input is const
#include <lzma.h>
#include <zlib.h>

#include "tools/log/packed_stream.hpp"

namespace odoless {
namespace {

constexpr std::uint64_t kDecoderBytesMax = 128ULL << 20U;

// Both libraries want unsigned bytes where files have characters.
std::uint8_t* as_bytes(char* characters) { return reinterpret_cast<std::uint8_t*>(characters); }
const std::uint8_t* as_bytes(const char* characters) { return reinterpret_cast<const std::uint8_t*>(characters); }

class GzipStream : public PackedStream {
 public:
  GzipStream(std::unique_ptr<ByteStream> packed, const std::string& name) : PackedStream(std::move(packed), name) {
    constexpr int kGzipOnly = 16 + MAX_WBITS;
    if (inflateInit2(&state_, kGzipOnly) != Z_OK) {
      fail_damaged();
    }
  }
  GzipStream(const GzipStream&) = delete;
  GzipStream(GzipStream&&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;
  GzipStream& operator=(GzipStream&&) = delete;
  ~GzipStream() override { inflateEnd(&state_); }

 private:
  void begin_frame() override { inflateReset(&state_); }

  bool step(std::span<const char>& in, std::span<char>& out) override {
    state_.next_in = as_bytes(in.data());
    state_.avail_in = static_cast<uInt>(in.size());
    state_.next_out = as_bytes(out.data());
    state_.avail_out = static_cast<uInt>(out.size());
    const int status = inflate(&state_, Z_NO_FLUSH);
    if (status != Z_STREAM_END && status != Z_OK && status != Z_BUF_ERROR) {
      fail_damaged();
    }
    in = in.last(state_.avail_in);
    out = out.last(state_.avail_out);
    return status != Z_STREAM_END;
  }

  z_stream state_{};
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
