#pragma once

#include <cstdint>

namespace odoless {

/// Lets one thread sleep until another has something for it: a Linux eventfd.
///
/// Notifications that come before the sleeper looks are one; none is lost. Check for work after each `wait`, also after
/// one that was false.
///
/// Thread:    `notify` from any thread and from signal handlers; `wait` from one.
/// Real time: `notify` is one system call (write) that never blocks; `wait` is two (ppoll, read).
class WakeUp {
 public:
  /// A program that has no file descriptor left when it starts is broken: checked.
  WakeUp();
  ~WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;
  WakeUp(WakeUp&&) = delete;
  WakeUp& operator=(WakeUp&&) = delete;

  void notify() const;

  /// Sleeps until `notify`, at most `timeout_ns`; for ever if that is negative.
  ///
  /// @return  True if notified; false after the time or after a signal.
  bool wait(std::int64_t timeout_ns);

  /// Becomes readable with `notify`, for a poll with other descriptors. Call `wait(0)` then, which makes it unreadable.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace odoless
