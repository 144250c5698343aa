#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/result.hpp"
#include "core/base/stamped_history.hpp"

namespace odoless {

/// The tilt axis's last angles, for the angle at which each beam was measured.
///
/// Thread: one thread. Real time: as StampedHistory.
class TiltHistory {
 public:
  static constexpr std::size_t kSamples = 512;

  /// @param gap_max_ns  Between samples farther apart than this nothing is known of the angle.
  explicit TiltHistory(std::int64_t gap_max_ns) : angles_(kSamples, gap_max_ns) {}

  /// Adds an angle; false, and nothing added, where the stamp is not later than the last one's or the angle is not
  /// finite. The oldest goes when there are more than kSamples.
  bool add(std::int64_t stamp_ns, double angle_rad) {
    return std::isfinite(angle_rad) && angles_.add(stamp_ns, angle_rad);
  }

  /// Forgets all: the axis was moved unseen.
  void clear() { angles_.clear(); }

  /// The angle at that moment, on the line between its two neighbours; errors as StampedHistory::at.
  [[nodiscard]] Result<double> angle_rad(std::int64_t stamp_ns) const { return angles_.at(stamp_ns); }

  [[nodiscard]] std::size_t size() const { return angles_.size(); }

 private:
  StampedHistory<double, OnTheLine> angles_;
};

}  // namespace odoless
