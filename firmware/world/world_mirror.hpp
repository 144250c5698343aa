#pragma once

#include <vector>

#include "core/graph/submap_graph.hpp"
#include "firmware/world/world_contents.hpp"

namespace odoless {

/// What a file has of a session, so that only what is new or changed is written. The graph itself holds what could not
/// be written yet: no further memory is needed for it.
///
/// Thread: owned by one thread.
class WorldMirror {
 public:
  static constexpr int kKeyframes_max = 256;  ///< that are taken from a graph at a time

  /// Of a file that has nothing of it yet.
  WorldMirror() = default;
  /// Of a file that has all of it.
  explicit WorldMirror(const SubmapWorld& world);

  /// Adds what the file does not have: keyframes where `changes` has none yet, submaps whose keyframes are there,
  /// constraints, poses and weights. Of a path in a world that stays as it is there is nothing.
  /// @return  Whether there is more.
  bool collect(const SubmapGraph& graph, WorldChanges& changes) const;
  /// These are in the file.
  void take(const WorldChanges& changes);
  /// Keyframes from that one on, which are in no submap, are no more in the file.
  void forget_keyframes(int from) { keyframes_ = from; }

  [[nodiscard]] int keyframes() const { return keyframes_; }

 private:
  void collect_constraints(const PoseGraph& graph, int submaps, WorldChanges& changes) const;

  int keyframes_ = 0;
  std::vector<Pose2> poses_;     ///< of submaps
  std::vector<double> weights_;  ///< of constraints
};

}  // namespace odoless
