#pragma once

#include <atomic>

namespace odoless {

/// Asks loops to end. Thread: any, and signal handlers.
class StopFlag {
 public:
  void request() { requested_.store(true, std::memory_order_release); }
  [[nodiscard]] bool requested() const { return requested_.load(std::memory_order_acquire); }

 private:
  std::atomic<bool> requested_ = false;
};

}  // namespace odoless
