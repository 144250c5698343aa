#pragma once

#include <vector>

#include "core/graph/graph_params.hpp"
#include "core/graph/keyframe_store.hpp"
#include "core/graph/odometry_stretch.hpp"

namespace odoless {

/// A rigid group of keyframes. Its frame is that of its middle keyframe, the origin.
struct Submap {
  int first_keyframe = 0;
  int keyframes = 0;
  Pose2 odom_T_submap{};
  Pose2 local_T_submap{};  ///< as the particle filter had it in its own map when the submap ended
  std::int64_t origin_stamp_ns = 0;

  [[nodiscard]] int end_keyframe() const { return first_keyframe + keyframes; }
};

/// Makes these keyframes a submap, and places them in it.
[[nodiscard]] Submap make_submap(KeyframeStore& store, int first_keyframe, int keyframes);

/// Cuts the stream of keyframes into submaps: one ends after a few metres, where the odometry may have slipped by too
/// much, and before a motion that is not credible.
///
/// Thread: owned by one thread. No allocation after construction but the store's.
class SubmapBuilder {
 public:
  explicit SubmapBuilder(const GraphParams& params);

  /// Whether the submap that has begun is to end before a keyframe that comes by this step.
  [[nodiscard]] bool is_to_end(const OdometryStretch& step) const {
    return !begun_.empty() && (step.is_torn() || is_full());
  }
  /// Every keyframe. While the store is full its motion alone is noted.
  void add(const Keyframe& keyframe, std::span<const BeamCode> codes, KeyframeStore& store);
  /// The same of a keyframe that the store has already.
  void add_stored(int index, const KeyframeStore& store);
  /// Goes on after a submap that was made before, whose keyframes the store has.
  void resume(const Submap& last, const KeyframeStore& store);
  /// So many keyframes before those of the submap that has begun are no more.
  void renumber(int keyframes) {
    for (Begun& each : begun_) {
      each.index -= keyframes;
    }
  }
  /// Ends the submap that has begun: `finished` says which. @return  Whether there was one.
  bool finish(KeyframeStore& store);

  /// Whether the submap that has begun lies behind a motion that is not credible.
  [[nodiscard]] bool is_behind_unknown_motion() const { return !begun_.empty() && begun_.front().since_last.is_torn(); }
  [[nodiscard]] const Submap& finished() const { return finished_; }
  /// From the origin of the submap before to the finished one's; default for the first one.
  [[nodiscard]] const OdometryStretch& odometry() const { return odometry_; }
  /// From the finished submap's origin, or the beginning, to the newest keyframe.
  [[nodiscard]] OdometryStretch since_origin() const;

 private:
  struct Begun {
    int index = 0;
    OdometryStretch since_last;  ///< from the keyframe before that is stored
  };

  [[nodiscard]] bool is_full() const;
  void pass(const OdometryStretch& step);

  GraphParams params_;
  std::vector<Begun> begun_;
  OdometryStretch since_stored_;  ///< to the newest keyframe
  OdometryStretch since_origin_;  ///< of the submap before to its end
  double travel_m_ = 0.0;
  double slip_m_ = 0.0;
  bool has_origin_ = false;
  Submap finished_;
  OdometryStretch odometry_;
};

}  // namespace odoless
