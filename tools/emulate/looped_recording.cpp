#include "tools/emulate/looped_recording.hpp"

namespace odoless {

void LoopedRecording::step(std::int64_t now_ns) {
  for (const ServoFrame& frame : line_.read()) {
    player_.receive({reinterpret_cast<const char*>(frame.data()), frame.size()}, now_ns);
  }
  for (const std::string& piece : player_.take_due(now_ns)) {
    const auto bytes = std::as_bytes(std::span(piece.data(), piece.size()));
    line_.write({bytes.begin(), bytes.end()});
  }
}

}  // namespace odoless
