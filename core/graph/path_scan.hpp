#pragma once

#include "core/geometry/pose2.hpp"

namespace odoless {

/// A keyframe of a piece of a path, in the frame of the piece.
struct PathScan {
  int keyframe = 0;
  Pose2 piece_T_scan{};
};

}  // namespace odoless
