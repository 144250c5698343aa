#pragma once

#include <memory>

#include "firmware/world/world_contents.hpp"

namespace odoless {

/// A world without the submaps that newer visits have made needless (core/graph/world_thinning.hpp). A session that has
/// none left keeps its record, but not its odometry. Null: none is needless.
///
/// Thread: owned by one thread. Not for real-time threads: it takes some 1 ms for each submap.
[[nodiscard]] std::unique_ptr<StoredWorld> thinned(const StoredWorld& world);

}  // namespace odoless
