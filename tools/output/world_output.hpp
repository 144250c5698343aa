#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/geometry/stamped_pose.hpp"
#include "core/graph/submap_graph.hpp"
#include "firmware/world/continued_world.hpp"
#include "firmware/world/world_file.hpp"

namespace odoless {

/// A world file that a run's pose graph goes to, as a session of its own, and that it goes on with; or one that it only
/// finds its way in.
class WorldOutput {
 public:
  /// Opens it, or makes it where it may grow. @param program  Version.
  /// @throws CannotCreateError, NoInputError, DataError.
  WorldOutput(std::filesystem::path path, const std::string& program, const RobotParams& params,
              WorldUse use = WorldUse::kContinue);

  /// What the file has; null: nothing yet.
  [[nodiscard]] const StoredWorld* world() const { return world_.stored(); }

  /// Submaps of it that newer visits have made needless, and that were left out (ContinuedWorld::make_room).
  [[nodiscard]] int left_out() const { return left_out_; }

  /// What the run has mapped, if it has. @param odom  odom_T_scan of all scans. @throws IoError.
  void write(const SessionRecord& session, const SubmapGraph& graph, std::span<const StampedPose> odom);

 private:
  std::filesystem::path path_;
  WorldFile file_;
  ContinuedWorld world_;
  int left_out_ = 0;
};

/// Opens a world to read it. @throws NoInputError, DataError.
void open_world(const std::filesystem::path& path, WorldFile& file);

}  // namespace odoless
