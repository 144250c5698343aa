#include "firmware/sources/line_keeper.hpp"

#include <algorithm>
#include <utility>

namespace odoless {

LineKeeper::LineKeeper(Open open, LineHandover& line, const WakeUp& sensor)
    : open_(std::move(open)), line_(line), sensor_(sensor) {}

LineKeeper::~LineKeeper() {
  const FileDescriptor offered(line_.offered.exchange(-1));
  const FileDescriptor returned(line_.returned.exchange(-1));
}

Errc LineKeeper::tick(std::int64_t now_ns) {
  const bool in_use =
      line_.in_use.load(std::memory_order_acquire);  // first: a line that was returned is then seen, too
  const FileDescriptor returned(line_.returned.exchange(-1, std::memory_order_acq_rel));  // closed here
  if (returned.valid()) {
    next_try_ns_ = now_ns + kPauseMin_ns;
    return Errc::kOk;
  }
  if (in_use || now_ns < next_try_ns_) {
    return Errc::kOk;
  }
  Result<FileDescriptor> opened = open_();
  if (!opened.ok()) {
    next_try_ns_ = now_ns + pause_ns_;
    pause_ns_ = std::min(2 * pause_ns_, kPauseMax_ns);
    return opened.error();
  }
  pause_ns_ = kPauseMin_ns;
  line_.in_use.store(true, std::memory_order_release);
  line_.offered.store(opened.take().release(), std::memory_order_release);
  sensor_.notify();
  return Errc::kOk;
}

}  // namespace odoless
