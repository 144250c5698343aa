#pragma once

#include <memory>

#include "firmware/world/world_contents.hpp"
#include "firmware/world/world_file.hpp"

namespace odoless {

/// A world without the submaps that newer visits have made needless (core/graph/world_thinning.hpp). A session keeps
/// its record, and its odometry from the first keyframe that is left on. Null: none is needless.
///
/// Thread: owned by one thread. Not for real-time threads: it takes half a millisecond for each submap.
[[nodiscard]] std::unique_ptr<StoredWorld> thinned(const StoredWorld& world);

/// Leaves out of a world's file what was left out of it, all or nothing. @param file  Open to write.
FileFailure leave_out(WorldFile& file, const StoredWorld& world, const StoredWorld& thin);

}  // namespace odoless
