#pragma once

#include <filesystem>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {

struct ReferencePose {
  double stamp_s = 0.0;
  Pose2 pose;  ///< of the laser in the reference's own world frame, unless its maker says otherwise
};

/// What an estimate is compared with. For evaluation alone: nothing of it may reach the SLAM.
struct ReferencePoses {
  bool is_log = false;     ///< one pose per scan of a log, so that its index is the scan's
  bool has_stamps = true;  ///< false: a log whose stamps tell nothing; stamp_s is then 0
  std::vector<ReferencePose> poses;
};

/// Reads, plain, .gz or .xz: a CARMEN log (the laser's pose of every FLASER or ROBOTLASER1 message), `stamp x y yaw`,
/// or TUM `stamp tx ty tz qx qy qz qw`; told apart by content, `#` begins a comment.
/// @throws DataError, NoInputError, IoError.
[[nodiscard]] ReferencePoses read_reference_poses(const std::filesystem::path& path);

/// The same from lines that somebody else opened.
[[nodiscard]] ReferencePoses read_reference_poses(LineReader& lines);

}  // namespace odoless
