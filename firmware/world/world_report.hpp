#pragma once

#include <cstdint>
#include <string>

namespace odoless {

/// How a world file is kept up.
struct WorldReport {
  std::string file;
  bool is_read_only = false;   ///< the robot only finds its way in it
  bool is_going_over = false;  ///< it is being closed for that, or opened again to map
  std::string uuid;
  std::int64_t revision = 0;
  std::int64_t session = 0;         ///< number in the file; 0: not yet in it
  std::int64_t keyframes = 0;       ///< of this session that are in the file
  std::int64_t not_written = 0;     ///< keyframes of this session that are not yet
  std::int64_t scans_lost = 0;      ///< whose poses found no room while nothing could be written
  std::int64_t keyframes_lost = 0;  ///< of a map that was begun anew while nothing could be written
  double age_s = 0.0;               ///< since all was written
  int error = 0;                    ///< errno of the last attempt; 0: it succeeded
  std::string reason{};             ///< for a person, with an error
  std::string refused{};            ///< why mapping does not go on, when that was asked for last
};

}  // namespace odoless
