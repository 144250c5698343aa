#pragma once

#include <cstddef>
#include <vector>

#include "core/graph/pose_graph.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "core/graph/world_thinning.hpp"

namespace odoless {

/// Where the submaps lay that a run has forgotten, or that newer ones have made needless: its trajectory is corrected
/// by them. Of more than kSubmaps_max (300 km) the older half goes.
///
/// Thread: owned by one thread. Memory: 64 bytes for each.
class PastPath {
 public:
  static constexpr std::size_t kSubmaps_max = 65'536;

  /// @param is_joined  It is known where it lies in the world, and with it all before it.
  void add(const SubmapPlace& submap, bool is_joined) { append({submap, SubmapNumbers::kNone}, is_joined); }
  /// It lies by another one, which stays, and moves with it.
  void add(const Submap& submap, int by, const Pose2& by_T_submap) {
    append({{submap.odom_T_submap, by_T_submap, submap.origin_stamp_ns}, by}, true);
  }
  /// Those of which it was not known lie there.
  void join(const Pose2& new_T_map);
  /// It will never be known of them.
  void lose() { submaps_.resize(joined_); }
  /// Submaps have other numbers. @param before  Where each lay. @param graph  Where they lie by their numbers now.
  void renumber(const SubmapNumbers& numbers, const std::vector<Pose2>& before, const PoseGraph& graph);
  /// In the order in which they were added.
  [[nodiscard]] std::vector<SubmapPlace> submaps(const PoseGraph& graph) const;

 private:
  struct Past {
    SubmapPlace place;  ///< in the map, or in the frame of the submap that it lies by
    int by = SubmapNumbers::kNone;
  };

  void append(const Past& submap, bool is_joined);

  std::vector<Past> submaps_;
  std::size_t joined_ = 0;
};

}  // namespace odoless
