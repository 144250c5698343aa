#pragma once

#include <memory>
#include <optional>
#include <string>

#include "config/robot_params.hpp"
#include "core/graph/submap_graph.hpp"
#include "firmware/world/world_contents.hpp"
#include "firmware/world/world_file.hpp"
#include "firmware/world/world_mirror.hpp"

namespace odoless {

/// A world that a new run goes on with: what its file has, and where the new run's numbers begin there.
///
/// Thread: owned by one thread. Not for real-time threads.
class ContinuedWorld {
 public:
  /// Reads a file that is open. Keyframes that a run left in no submap, as after a power cut or a reset, are made into
  /// submaps, in the file too where that is open to write.
  /// @param params  How these are made. @param use  To localise, there must be a map.
  /// Errors: EBADMSG where the file cannot be gone on with.
  FileFailure read(WorldFile& file, const RobotParams& params, WorldUse use);

  /// Of a world that is three quarters full, leaves out what newer visits have made needless (thinned_world.hpp), where
  /// that is a tenth of it: here and in the file, which is open to write. What cannot be written stays as it is.
  /// @return  Submaps that were left out.
  int make_room(WorldFile& file, const GraphParams& params);

  /// Nothing: the file has no submap yet, or it was forgotten.
  [[nodiscard]] const StoredWorld* stored() const { return stored_.get(); }
  /// It was copied to where it is gone on with.
  void forget() { stored_.reset(); }
  [[nodiscard]] const WorldMirror& mirror() const { return mirror_; }

 private:
  std::unique_ptr<StoredWorld> stored_;
  WorldMirror mirror_;
};

/// Why a pose graph has no room for a world, and what would have, for a person.
[[nodiscard]] std::string no_room_sentence(const StoredWorld& world, const GraphParams& params);

}  // namespace odoless
