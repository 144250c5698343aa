#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/match/pose_search.hpp"
#include "core/optimize/nelder_mead.hpp"

namespace odoless {

/// The best poses of many, each clearly apart from the others.
///
/// Thread: owned by one thread. Real time: no allocation after construction; an offer is linear in the capacity, and
/// one that is worse than all is refused at once when full.
class ApartPoses {
 public:
  /// @param capacity  At least 1.
  explicit ApartPoses(int capacity) : poses_(static_cast<std::size_t>(capacity)) {}

  void clear() { size_ = 0; }

  /// Takes a pose in place of one that is the same but worse, while there is room, or in place of the worst.
  void offer(const ScoredPoint& pose) {
    if (size_ == poses_.size() && pose.score <= poses_[worst_].score) {
      return;
    }
    std::size_t place = size_ < poses_.size() ? size_ : worst_;
    for (std::size_t i = 0; i < size_; ++i) {
      if (!clearly_apart(poses_[i].point, pose.point)) {
        if (poses_[i].score >= pose.score) {
          return;
        }
        place = i;
      }
    }
    poses_[place] = pose;
    size_ = std::max(size_, place + 1);
    const auto by_score = [](const ScoredPoint& a, const ScoredPoint& b) { return a.score < b.score; };
    worst_ = static_cast<std::size_t>(std::min_element(poses_.begin(), end(), by_score) - poses_.begin());
  }

  /// In no order.
  [[nodiscard]] std::span<const ScoredPoint> poses() const { return {poses_.data(), size_}; }

 private:
  [[nodiscard]] std::vector<ScoredPoint>::iterator end() { return poses_.begin() + static_cast<std::ptrdiff_t>(size_); }

  std::vector<ScoredPoint> poses_;
  std::size_t size_ = 0;
  std::size_t worst_ = 0;
};

}  // namespace odoless
