#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/robot_params.hpp"
#include "firmware/world/world_contents.hpp"

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

/// Runs sessions again, from their keyframes, in the world of a file, as if they had been driven there: one that is
/// found in it for sure (Localiser), and that kClosures_min loop closures hold there, is written to the file as a
/// session of its own. The others are tried again after each that was, and are else left out.
/// @param from  Their world. @param into  File of the other world.
/// @return  In the order of `sessions`. @throws CannotCreateError, DataError, IoError.
[[nodiscard]] std::vector<MergedSession> merge_sessions(const StoredWorld& from,
                                                        const std::vector<SessionToMerge>& sessions,
                                                        const std::filesystem::path& into,
                                                        const MergeProgress& progress);

inline constexpr int kClosures_min = 3;

}  // namespace odoless
