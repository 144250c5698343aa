#pragma once

#include <cstdint>
#include <deque>
#include <fstream>
#include <functional>
#include <string>

#include "tools/emulate/device_loop.hpp"
#include "tools/emulate/emulated_line.hpp"
#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

/// What an emulation has done.
struct LrfEmulation {
  std::int64_t scans = 0;    ///< handed to the line as a whole
  std::int64_t dropped = 0;  ///< because the client didn't read
};

/// An emulated laser on a line.
///
/// Each scan that is sent adds a TUM line to the truth: when its first beam was measured (the monotonic clock moved to
/// the Unix epoch as it is at construction, which is what the daemon stamps with) and where the robot was.
class LoopedLrf final : public LoopedDevice {
 public:
  /// What is given by reference must outlive it.
  /// @param truth   File to write; empty: none.
  /// @param on_end  Called once, when the drive or the log is over.
  /// @throws CannotCreateError, and IoError from `step`, for the truth.
  LoopedLrf(EmulatedLrf& device, const EmulatedScans& source, EmulatedLine& line, const std::string& truth,
            std::function<void()> on_end);

  void step(std::int64_t now_ns) override;
  [[nodiscard]] pollfd waits_for() override;
  [[nodiscard]] std::int64_t next_event_ns() const override { return device_.next_event_ns(); }
  [[nodiscard]] bool is_over() const override { return is_over_; }

  [[nodiscard]] const LrfEmulation& done() const { return done_; }

 private:
  void queue(SentBytes sent);
  void write();
  void tell_truth(const SentScan& scan);

  EmulatedLrf& device_;
  const EmulatedScans& source_;
  EmulatedLine& line_;
  std::ofstream truth_;
  std::function<void()> on_end_;
  std::int64_t epoch_offset_ns_;
  std::deque<SentBytes> waiting_;
  std::size_t begun_bytes_ = 0;  ///< of the first that waits: already written
  bool has_client_ = false;
  bool is_over_ = false;
  LrfEmulation done_;
};

}  // namespace odoless
