#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include "tools/log/packed_stream.hpp"
#include "tools/log/unpack.hpp"

namespace odoless {
namespace {

class Bzip2Stream : public PackedStream {
 public:
  Bzip2Stream(std::unique_ptr<ByteStream> packed, const std::string& name) : PackedStream(std::move(packed), name) {
    begin();
  }
  Bzip2Stream(const Bzip2Stream&) = delete;
  Bzip2Stream(Bzip2Stream&&) = delete;
  Bzip2Stream& operator=(const Bzip2Stream&) = delete;
  Bzip2Stream& operator=(Bzip2Stream&&) = delete;
  ~Bzip2Stream() override { BZ2_bzDecompressEnd(&state_); }

 private:
  void begin() {
    state_ = {};
    if (BZ2_bzDecompressInit(&state_, 0, 0) != BZ_OK) {
      fail_damaged();
    }
  }

  void begin_frame() override {
    BZ2_bzDecompressEnd(&state_);
    begin();
  }

  bool step(std::span<const char>& in, std::span<char>& out) override {
    state_.next_in = const_cast<char*>(in.data());  // it is only read
    state_.avail_in = static_cast<unsigned>(in.size());
    state_.next_out = out.data();
    state_.avail_out = static_cast<unsigned>(out.size());
    const int status = BZ2_bzDecompress(&state_);
    if (status != BZ_OK && status != BZ_STREAM_END) {
      fail_damaged();
    }
    in = in.last(state_.avail_in);
    out = out.last(state_.avail_out);
    return status != BZ_STREAM_END;
  }

  bz_stream state_{};
};

class Lz4Stream : public PackedStream {
 public:
  Lz4Stream(std::unique_ptr<ByteStream> packed, const std::string& name) : PackedStream(std::move(packed), name) {
    LZ4F_dctx* state = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&state, LZ4F_VERSION)) != 0) {
      fail_damaged();
    }
    state_.reset(state);
  }

 private:
  void begin_frame() override { LZ4F_resetDecompressionContext(state_.get()); }

  bool step(std::span<const char>& in, std::span<char>& out) override {
    std::size_t in_bytes = in.size();
    std::size_t out_bytes = out.size();
    const std::size_t status = LZ4F_decompress(state_.get(), out.data(), &out_bytes, in.data(), &in_bytes, nullptr);
    if (LZ4F_isError(status) != 0) {
      fail_damaged();
    }
    in = in.subspan(in_bytes);
    out = out.subspan(out_bytes);
    return status != 0;
  }

  std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> state_{nullptr, &LZ4F_freeDecompressionContext};
};

class ZstdStream : public PackedStream {
 public:
  ZstdStream(std::unique_ptr<ByteStream> packed, const std::string& name)
      : PackedStream(std::move(packed), name), state_(ZSTD_createDStream(), &ZSTD_freeDStream) {
    if (!state_) {
      fail_damaged();
    }
  }

 private:
  void begin_frame() override { ZSTD_DCtx_reset(state_.get(), ZSTD_reset_session_only); }

  bool step(std::span<const char>& in, std::span<char>& out) override {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    const std::size_t status = ZSTD_decompressStream(state_.get(), &to, &from);
    if (ZSTD_isError(status) != 0) {
      fail_damaged();
    }
    in = in.subspan(from.pos);
    out = out.subspan(to.pos);
    return status != 0;
  }

  std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> state_;
};

}  // namespace

std::unique_ptr<ByteStream> unpack_bzip2(std::unique_ptr<ByteStream> packed, const std::string& name) {
  return std::make_unique<Bzip2Stream>(std::move(packed), name);
}

std::unique_ptr<ByteStream> unpack_lz4(std::unique_ptr<ByteStream> packed, const std::string& name) {
  return std::make_unique<Lz4Stream>(std::move(packed), name);
}

std::unique_ptr<ByteStream> unpack_zstd(std::unique_ptr<ByteStream> packed, const std::string& name) {
  return std::make_unique<ZstdStream>(std::move(packed), name);
}

}  // namespace odoless
