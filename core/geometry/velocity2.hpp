#pragma once

namespace odoless {

/// Speed in the plane, in the axes of what moves.
struct Velocity2 {
  double x_mps = 0.0;
  double y_mps = 0.0;
  double yaw_radps = 0.0;
};

}  // namespace odoless
