#include "firmware/lcm/deflater.hpp"

#define ZLIB_CONST  // zlib then promises not to write to its input
#include <zlib.h>

#include <vector>

#include "core/base/check.hpp"

namespace odoless {

// What zlib asks for comes out of one block, so that a lack of memory is told as everywhere.
struct Deflater::State {
  static constexpr std::size_t kBlock_bytes = 320 << 10;  // zlib.h: 256 KiB and a few more, by default

  z_stream stream{};
  std::vector<std::uint8_t> block = std::vector<std::uint8_t>(kBlock_bytes);
  std::size_t taken_bytes = 0;

  static void* take(void* state, uInt items, uInt item_bytes) {
    constexpr std::size_t kAlignment = 16;
    auto& self = *static_cast<State*>(state);
    const std::size_t bytes = (std::size_t{items} * item_bytes + kAlignment - 1) / kAlignment * kAlignment;
    if (bytes > kBlock_bytes - self.taken_bytes) {
      return nullptr;
    }
    self.taken_bytes += bytes;
    return self.block.data() + self.taken_bytes - bytes;
  }
  static void leave(void* /*state*/, void* /*memory*/) {}  // all at once, with the block
};

Deflater::Deflater() : state_(std::make_unique<State>()) {
  state_->stream.opaque = state_.get();
  state_->stream.zalloc = State::take;
  state_->stream.zfree = State::leave;
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
