#pragma once

#include <cstdint>
#include <functional>

#include "core/base/result.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "firmware/sources/line_handover.hpp"
#include "rt/wake_up.hpp"

namespace odoless {

/// Opens a device's line for the sensor thread, again and again with growing pauses, and closes what it gives back.
///
/// Thread: supervisor; not real-time.
class LineKeeper {
 public:
  using Open = std::function<Result<FileDescriptor>()>;

  LineKeeper(Open open, LineHandover& line, const WakeUp& sensor);
  LineKeeper(const LineKeeper&) = delete;
  LineKeeper& operator=(const LineKeeper&) = delete;
  LineKeeper(LineKeeper&&) = delete;
  LineKeeper& operator=(LineKeeper&&) = delete;
  ~LineKeeper();

  /// Does what is due. @return kOk while the line is open or nothing was tried, else why it could not be opened.
  [[nodiscard]] Errc tick(std::int64_t now_ns);

 private:
  static constexpr std::int64_t kPauseMin_ns = 100'000'000;
  static constexpr std::int64_t kPauseMax_ns = 500'000'000;

  Open open_;
  LineHandover& line_;
  const WakeUp& sensor_;
  std::int64_t next_try_ns_ = 0;
  std::int64_t pause_ns_ = kPauseMin_ns;
};

}  // namespace odoless
