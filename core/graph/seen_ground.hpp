#pragma once

#include <cstdint>
#include <unordered_map>

#include "core/graph/keyframe_store.hpp"

namespace odoless {

/// The ground that keyframes have seen from within 6 m, as cells of 0.25 m, a bit each. Parts of a world that lie on
/// top of each other are apart.
///
/// Frames: map. Memory: some 1 byte for each cell. Not for real-time threads.
class SeenGround {
 public:
  /// What a keyframe saw, where no wall is in between. @param part  Of the world.
  void see(int part, const KeyframeStore& store, int keyframe, const Pose2& map_T_scan);
  void add(const SeenGround& other);
  /// Of this ground, what the other one has as well, or next to it: where a wall is at the edge of a cell, one visit
  /// has it and the other one has not. 0 without any.
  [[nodiscard]] double share_in(const SeenGround& other) const;

 private:
  class Cell;

  [[nodiscard]] bool has(const Cell& cell) const;
  [[nodiscard]] bool has_near(const Cell& cell) const;

  std::unordered_map<std::int64_t, std::uint64_t> blocks_;  ///< of 8 x 8 cells
};

}  // namespace odoless
