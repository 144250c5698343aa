#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/check.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// Points with fixed capacity, coordinates apart so that loops over them vectorise.
class PointSet {
 public:
  explicit PointSet(int capacity)
      : x_m_(static_cast<std::size_t>(capacity)), y_m_(static_cast<std::size_t>(capacity)) {}

  void clear() { size_ = 0; }
  void push_back(const Point2& p) {
    ODOLESS_CHECK(size_ < capacity());
    x_m_[static_cast<std::size_t>(size_)] = static_cast<float>(p.x_m);
    y_m_[static_cast<std::size_t>(size_)] = static_cast<float>(p.y_m);
    ++size_;
  }

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int capacity() const { return static_cast<int>(x_m_.size()); }
  [[nodiscard]] Point2 operator[](int i) const {
    return {x_m_[static_cast<std::size_t>(i)], y_m_[static_cast<std::size_t>(i)]};
  }
  [[nodiscard]] std::span<const float> x_m() const { return {x_m_.data(), static_cast<std::size_t>(size_)}; }
  [[nodiscard]] std::span<const float> y_m() const { return {y_m_.data(), static_cast<std::size_t>(size_)}; }

 private:
  int size_ = 0;
  std::vector<float> x_m_;
  std::vector<float> y_m_;
};

/// Appends the returns of `scan`, moved by `target_T_scan`, one per `spacing_m` of arc along what the beams hit: a near
/// wall, where the beams crowd, then says no more than a far one. 0 keeps every return.
///
/// Real time: no allocation; `out` must have room for all returns.
void append_thinned(const ScanFrame& scan, const Pose2& target_T_scan, double spacing_m, PointSet& out);

}  // namespace odoless
