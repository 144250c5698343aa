#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "core/graph/submap_graph.hpp"
#include "firmware/world/world_contents.hpp"
#include "firmware/world/world_file.hpp"
#include "firmware/world/world_mirror.hpp"

namespace odoless::test {

/// Little memory, short submaps.
inline GraphParams small_graph() {
  GraphParams params;
  params.submaps_max = 64;
  params.constraints_max = 256;
  params.keyframes_max = 1024;
  params.keyframe_beams_max = 91;
  params.submap_keyframes = 5;
  params.references = 1;
  params.candidates = 1;
  return params;
}

/// A keyframe that a robot on a circle may have taken; its numbers are odd on purpose.
inline StoredKeyframe keyframe_at(int index, Rng& rng, int map_number = 0) {
  StoredKeyframe out;
  Keyframe& keyframe = out.keyframe;
  keyframe.stamp_ns = 1'000'000'007LL + index * 25'000'003LL;
  keyframe.start_angle_rad = -1.5707963267948966;
  keyframe.angle_step_rad = 3.1415926535897931 / 90.0;
  keyframe.beams = 91;
  keyframe.map_number = map_number;
  const double turn_rad = 0.1 * index;
  keyframe.odom_T_scan = {4.0 * std::sin(turn_rad), 4.0 - 4.0 * std::cos(turn_rad), wrap_angle(turn_rad)};
  if (index > 0) {
    const double before_rad = turn_rad - 0.1;
    const Pose2 before{4.0 * std::sin(before_rad), 4.0 - 4.0 * std::cos(before_rad), wrap_angle(before_rad)};
    keyframe.since_last.start_T_end = before.inverse() * keyframe.odom_T_scan;
    keyframe.since_last.distance_m = 0.4;
    keyframe.since_last.rotation_rad = 0.1;
    for (double& value : keyframe.since_last.covariance) {
      value = rng.uniform(-1e-7, 1e-7);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      keyframe.since_last.covariance[4 * i] = 1e-5;
    }
  }
  out.codes.resize(91);
  for (BeamCode& code : out.codes) {
    code = static_cast<BeamCode>(rng.below(20) == 0 ? 0xffff : 700 + rng.below(40));
  }
  return out;
}

inline StampedPose odometry_of(const StoredKeyframe& of) { return {of.keyframe.stamp_ns, of.keyframe.odom_T_scan}; }

/// What a file does not have yet of a session.
inline void append(WorldFile& file, const WorldPlace& place, WorldMirror& mirror, const SubmapGraph& graph,
                   std::vector<StampedPose> odometry) {
  WorldChanges changes;
  changes.odometry = std::move(odometry);
  bool has_more = true;
  while (has_more) {
    has_more = mirror.collect(graph, changes);
    const FileFailure failed = file.write(place, changes);
    ASSERT_FALSE(failed.any()) << failed.text;
    mirror.take(changes);
    changes = {};
  }
}

inline bool is_same(const Pose2& a, const Pose2& b) {
  return a.x_m == b.x_m && a.y_m == b.y_m && a.yaw_rad == b.yaw_rad;
}

inline bool is_same(const Keyframe& a, const Keyframe& b) {
  return a.stamp_ns == b.stamp_ns && a.start_angle_rad == b.start_angle_rad && a.angle_step_rad == b.angle_step_rad &&
         a.beams == b.beams && a.map_number == b.map_number && is_same(a.odom_T_scan, b.odom_T_scan) &&
         is_same(a.map_T_odom, b.map_T_odom) && is_same(a.since_last.start_T_end, b.since_last.start_T_end) &&
         a.since_last.covariance == b.since_last.covariance && a.since_last.slip_m.x_m == b.since_last.slip_m.x_m &&
         a.since_last.slip_m.y_m == b.since_last.slip_m.y_m && a.since_last.distance_m == b.since_last.distance_m &&
         a.since_last.rotation_rad == b.since_last.rotation_rad && a.since_last.unknown_s == b.since_last.unknown_s;
}

}  // namespace odoless::test
