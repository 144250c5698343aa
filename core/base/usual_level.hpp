#pragma once

#include <algorithm>

namespace odoless {

/// What a figure of the scans has lately been like: their mean, those older than the memory counting less. Nothing is
/// usual before it has been seen for a while.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class UsualLevel {
 public:
  explicit UsualLevel(double memory_s) : memory_s_(memory_s) {}

  /// @param span_s  Time that the scan stands for.
  void add(double value, double span_s) {
    seen_s_ += std::max(kLeast_s, span_s);
    level_ += (value - level_) * std::min(1.0, std::max(kLeast_s, span_s) / std::min(seen_s_, memory_s_));
  }

  /// 0 until then.
  [[nodiscard]] double value() const { return seen_s_ >= kEnough_s ? level_ : 0.0; }

 private:
  static constexpr double kEnough_s = 5.0;
  static constexpr double kLeast_s = 1e-6;

  double memory_s_;
  double level_ = 0.0;
  double seen_s_ = 0.0;
};

}  // namespace odoless
