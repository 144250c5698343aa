#pragma once

#include <gtest/gtest.h>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// To the last bit.
inline ::testing::AssertionResult same_pose(const Pose2& a, const Pose2& b) {
  const bool same = a.x_m == b.x_m && a.y_m == b.y_m && a.yaw_rad == b.yaw_rad;
  return same ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << a.x_m << " is not " << b.x_m;
}

}  // namespace odoless
