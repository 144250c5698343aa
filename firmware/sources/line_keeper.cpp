#include "firmware/sources/line_keeper.hpp"

#include <algorithm>
#include <utility>

namespace odoless {

LineKeeper::LineKeeper(Open open, LineHandover& line, const WakeUp& sensor)
    : open_(std::move(open)), line_(line), sensor_(sensor) {}

LineKeeper::~LineKeeper() { const FileDescriptor left(line_.clear()); }

Errc LineKeeper::tick(std::int64_t now_ns) {
  const FileDescriptor returned(line_.take_back());  // closed here
  if (returned.valid()) {
    next_try_ns_ = now_ns + kPauseMin_ns;
    return Errc::kOk;
  }
  if (!line_.is_empty() || now_ns < next_try_ns_) {
    return Errc::kOk;
  }
  Result<FileDescriptor> opened = open_();
  if (!opened.ok()) {
    next_try_ns_ = now_ns + pause_ns_;
    pause_ns_ = std::min(2 * pause_ns_, kPauseMax_ns);
    return opened.error();
  }
  pause_ns_ = kPauseMin_ns;
  line_.offer(opened.take().release());
  sensor_.notify();
  return Errc::kOk;
}

}  // namespace odoless
