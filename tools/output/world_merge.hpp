#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/robot_params.hpp"
#include "firmware/world/world_contents.hpp"
#include "firmware/world/world_file.hpp"

namespace odoless {

/// A session that is to go into another world.
struct SessionToMerge {
  std::size_t number = 0;  ///< in its own world, from 0
  RobotParams params;      ///< that it was run with
};

/// What came of it.
struct MergedSession {
  std::size_t number = 0;
  int submaps = 0;
  int closures = 0;  ///< loop closures that hold between its submaps and those of before
  bool is_joined = false;
};

/// @param done  Keyframes of the sessions.
using MergeProgress = std::function<void(std::int64_t done)>;

/// Makes a world of one and of another's sessions, in a new file, which appears whole or not at all. The sessions are
/// run again, from their keyframes, as if they had been driven in the first world: one that is found in it for sure
/// (Localiser), and that kClosures_min loop closures hold there, is written as a session of its own. The others are
/// tried again after each that was, and are else left out. Where all are, no file is made.
/// @param into  Open, with a submap at least. @param from  The other world. @param out  Is not there.
/// @return  In the order of `sessions`. @throws CannotCreateError, DataError, IoError.
[[nodiscard]] std::vector<MergedSession> merge_sessions(WorldFile& into, const StoredWorld& from,
                                                        const std::vector<SessionToMerge>& sessions,
                                                        const std::filesystem::path& out,
                                                        const MergeProgress& progress);

inline constexpr int kClosures_min = 3;

}  // namespace odoless
