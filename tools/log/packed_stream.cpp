#include "tools/log/packed_stream.hpp"

#include "tools/command/error.hpp"

namespace odoless {

void PackedInput::fail_cut() const {
  throw DataError(name_, 0, "the compressed stream ends too early", "a complete file (is it cut?)");
}

void PackedInput::fail_damaged() const {
  throw DataError(name_, 0, "the compressed stream is damaged",
                  "a file that its own program accepts, as `gzip -t` does");
}

bool PackedStream::refill() {
  in_ = input_.next();
  if (in_.empty() && inside_frame_) {
    input_.fail_cut();
  }
  return !in_.empty();
}

std::size_t PackedStream::read(std::span<char> buffer) {
  std::span<char> out = buffer;
  while (out.size() == buffer.size() && !buffer.empty()) {
    if (in_.empty() && !has_more_ && !refill()) {
      break;
    }
    if (!inside_frame_) {
      begin_frame();
    }
    inside_frame_ = step(in_, out);
    has_more_ = inside_frame_ && out.empty();
  }
  return buffer.size() - out.size();
}

}  // namespace odoless
