#pragma once

#include <vector>

#include "core/scan/scan_frame.hpp"
#include "firmware/pipeline/messages.hpp"

namespace odoless {

/// All scans that are under way. A slot belongs to one thread at a time; queues hand it on.
class ScanPool {
 public:
  ScanPool(const ScanParams& params, int slots)
      : beams_max_(params.beams_max), slots_(static_cast<std::size_t>(slots), ScanFrame(params)) {}

  [[nodiscard]] ScanFrame& at(ScanSlot slot) { return slots_[slot]; }
  [[nodiscard]] int size() const { return static_cast<int>(slots_.size()); }
  [[nodiscard]] int beams_max() const { return beams_max_; }

 private:
  int beams_max_;
  std::vector<ScanFrame> slots_;
};

/// The slots that the sensor thread has in its hands.
class FreeSlots {
 public:
  explicit FreeSlots(int slots) {
    free_.reserve(static_cast<std::size_t>(slots));
    for (int slot = slots - 1; slot >= 0; --slot) {
      free_.push_back(static_cast<ScanSlot>(slot));
    }
  }

  /// kNoSlot when there is none.
  [[nodiscard]] ScanSlot take() {
    if (free_.empty()) {
      return kNoSlot;
    }
    const ScanSlot slot = free_.back();
    free_.pop_back();
    return slot;
  }
  void give(ScanSlot slot) { free_.push_back(slot); }  // never more than reserved
  [[nodiscard]] std::size_t size() const { return free_.size(); }

 private:
  std::vector<ScanSlot> free_;
};

}  // namespace odoless
