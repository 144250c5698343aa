#pragma once

#include <algorithm>

namespace odoless {

/// What a figure of the scans has lately been like: their mean, older ones counting less. The first is taken as it is.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class UsualLevel {
 public:
  /// @param span_s  Time that the scan stands for.
  void add(double value, double span_s) {
    level_ = known_ ? level_ + (value - level_) * std::min(1.0, span_s / kMemory_s) : value;
    known_ = true;
  }

  /// 0 before the first.
  [[nodiscard]] double value() const { return level_; }

 private:
  static constexpr double kMemory_s = 5.0;

  double level_ = 0.0;
  bool known_ = false;
};

}  // namespace odoless
