#include "firmware/lcm/deflater.hpp"

#define ZLIB_CONST  // zlib then promises not to write to its input
#include <zlib.h>

#include "core/base/check.hpp"

namespace odoless {

struct Deflater::State {
  z_stream stream{};
};

Deflater::Deflater() : state_(std::make_unique<State>()) {
  ODOLESS_CHECK(deflateInit(&state_->stream, Z_DEFAULT_COMPRESSION) == Z_OK);
}

Deflater::~Deflater() { deflateEnd(&state_->stream); }

Result<std::size_t> Deflater::deflate(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  z_stream& stream = state_->stream;
  ODOLESS_CHECK(deflateReset(&stream) == Z_OK);
  stream.next_in = in.data();
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  if (::deflate(&stream, Z_FINISH) != Z_STREAM_END) {
    return Errc::kTooLong;
  }
  return out.size() - stream.avail_out;
}

}  // namespace odoless
