#pragma once

#include <span>
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
  /// constraints, poses and weights; and what the world has no more. Of a path in a world that stays as it is there is
  /// nothing.
  /// @param keyframes  Of the world, the first so many of its store.
  /// @return  Whether there is more.
  bool collect(const SubmapWorld& world, int keyframes, WorldChanges& changes) const;
  bool collect(const SubmapGraph& graph, WorldChanges& changes) const {
    return collect(graph.map(), graph.mapped_keyframes(), changes);
  }
  /// These are in the file.
  void take(const WorldChanges& changes);
  /// Keyframes of the world from that serial on, which are in no submap, are no more in the file.
  void forget_keyframes(int from_serial);

  /// Whether the file has all keyframes of a graph's world.
  [[nodiscard]] bool has_keyframes_of(const SubmapGraph& graph) const;
  [[nodiscard]] int keyframes() const { return static_cast<int>(serials_.size()); }
  /// Of these, those before that serial.
  [[nodiscard]] int keyframes_before(int serial) const;
  /// Of the first keyframe that the file does not have.
  [[nodiscard]] int next_serial() const { return serials_.empty() ? 0 : serials_.back() + 1; }

 private:
  void collect_left_out(const KeyframeStore& store, int keyframes, WorldChanges& changes) const;
  static void collect_constraints(const PoseGraph& graph, int submaps, std::span<const double> known,
                                  WorldChanges& changes);

  std::vector<int> serials_;     ///< of keyframes
  std::vector<Pose2> poses_;     ///< of submaps
  std::vector<double> weights_;  ///< of constraints
};

}  // namespace odoless
