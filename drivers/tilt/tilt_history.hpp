#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/result.hpp"

namespace odoless {

/// The tilt axis's last angles, for the angle at which each beam was measured.
///
/// Thread: one thread. Real time: no allocation; `angle_rad` takes at most log2(kSamples) steps.
class TiltHistory {
 public:
  static constexpr std::size_t kSamples = 512;

  /// @param gap_max_ns  Between samples farther apart than this nothing is known of the angle.
  explicit TiltHistory(std::int64_t gap_max_ns) : gap_max_ns_(gap_max_ns) {}

  /// Adds an angle; false, and nothing added, where the stamp is not later than the last one's or the angle is not
  /// finite. The oldest goes when there are more than kSamples.
  bool add(std::int64_t stamp_ns, double angle_rad);

  /// Forgets all: the axis was moved unseen.
  void clear() { count_ = 0; }

  /// The angle at that moment, on the line between its two neighbours.
  ///
  /// Errc::kNotYet: no later sample is there, perhaps one will come; kTooOld: the samples of that time are gone, or
  /// never were; kGap: the two neighbours are too far apart.
  [[nodiscard]] Result<double> angle_rad(std::int64_t stamp_ns) const;

  [[nodiscard]] std::size_t size() const { return count_; }

 private:
  struct Sample {
    std::int64_t stamp_ns = 0;
    double angle_rad = 0.0;
  };

  /// The i-th since the oldest.
  [[nodiscard]] const Sample& at(std::size_t i) const { return samples_[(first_ + i) % kSamples]; }

  std::int64_t gap_max_ns_;
  std::array<Sample, kSamples> samples_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace odoless
