#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/graph/trajectory_correction.hpp"

namespace odoless {

/// Where the submaps lay that a run has forgotten: its trajectory is corrected by them. Of more than kSubmaps_max (300
/// km) the older half goes.
///
/// Thread: owned by one thread. Memory: 56 bytes for each.
class PastPath {
 public:
  static constexpr std::size_t kSubmaps_max = 65'536;

  /// @param is_joined  It is known where it lies in the world, and with it all before it.
  void add(const SubmapPlace& submap, bool is_joined);
  /// Those of which it was not known lie there.
  void join(const Pose2& new_T_map);
  /// It will never be known of them.
  void lose() { submaps_.resize(joined_); }
  [[nodiscard]] std::span<const SubmapPlace> submaps() const { return submaps_; }

 private:
  std::vector<SubmapPlace> submaps_;
  std::size_t joined_ = 0;
};

}  // namespace odoless
