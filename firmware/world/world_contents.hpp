#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "core/graph/keyframe_store.hpp"
#include "core/graph/pose_graph.hpp"
#include "core/graph/submap_builder.hpp"
#include "core/graph/submap_matcher.hpp"

namespace odoless {

/// Which world it is, and which state of it.
struct WorldIdentity {
  std::string uuid;
  std::string created;        ///< UTC, as in 2026-11-23T08:15:00Z
  std::string program;        ///< version that made the file
  std::int64_t revision = 0;  ///< grows with each change of the map
};

/// One run of a daemon, or of a replay, in one world.
struct SessionRecord {
  std::string started;        ///< UTC
  std::string program;        ///< version
  std::string configuration;  ///< TOML
  std::int64_t seed = 0;      ///< random seed
};

/// Which numbers in the file a session's first keyframe, submap and constraint have.
struct WorldPlace {
  std::int64_t session = 0;
  std::int64_t keyframe = 0;
  std::int64_t submap = 0;
  std::int64_t constraint = 0;
};

struct StoredKeyframe {
  Keyframe keyframe;
  std::vector<BeamCode> codes;
  int serial = 0;  ///< KeyframeStore's
};

/// What a file does not have yet of a session. Keyframes go by their serial numbers; numbers of submaps and constraints
/// count from the session's first.
struct WorldChanges {
  /// Keyframes that the file has and the map has no more. Then all submaps and constraints are new: the file's are of
  /// other numbers.
  std::vector<int> left_out;
  struct Way {
    int keyframe = 0;
    OdometryStretch since_last;
  };
  std::vector<Way> ways;  ///< over what was left out
  std::vector<StoredKeyframe> keyframes;
  int first_submap = 0;
  std::vector<Submap> submaps;  ///< `first_keyframe` is a serial number
  struct Moved {
    int submap = 0;
    Pose2 map_T_submap{};
  };
  std::vector<Moved> moved;  ///< submaps, new ones too, and where they lie now
  int first_constraint = 0;
  std::vector<Constraint> constraints;
  struct Weighted {
    int constraint = 0;
    double weight = 0.0;
  };
  std::vector<Weighted> weighted;  ///< constraints that the file has, with another weight
  std::vector<StampedPose> odometry;

  [[nodiscard]] bool is_map_changed() const {
    return !left_out.empty() || !keyframes.empty() || !submaps.empty() || !moved.empty() || !constraints.empty() ||
           !weighted.empty();
  }
  [[nodiscard]] bool is_empty() const { return !is_map_changed() && odometry.empty(); }
};

/// A session as it was read; its keyframes and submaps are ranges of the world's.
struct StoredSession {
  std::int64_t id = 0;  ///< in the file
  SessionRecord about;
  int first_keyframe = 0;
  int keyframes = 0;
  int first_submap = 0;
  int submaps = 0;
  std::vector<StampedPose> odometry;  ///< odom_T_scan of all its scans
};

/// A world as it was read.
struct StoredWorld {
  StoredWorld(int keyframes, int beams_max, int submaps_max, int constraints_max)
      : store(keyframes, beams_max), graph(submaps_max, constraints_max) {}

  /// The map is of the largest part.
  [[nodiscard]] SubmapWorld world() const { return {store, graph, submaps, std::nullopt, graph.largest_component()}; }

  WorldIdentity identity;
  std::vector<StoredSession> sessions;
  KeyframeStore store;
  PoseGraph graph;
  std::vector<Submap> submaps;
  int submaps_in_file = 0;  ///< the others were made of keyframes that were in none
};

}  // namespace odoless
