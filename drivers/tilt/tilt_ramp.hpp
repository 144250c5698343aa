#pragma once

namespace odoless {

/// The way to a target with bounded speed and acceleration, step by step: for servos that are given each place on it.
///
/// Thread: one thread. Real time: constant time.
class TiltRamp {
 public:
  TiltRamp(double speed_radps, double acceleration_radps2)
      : speed_radps_(speed_radps), acceleration_radps2_(acceleration_radps2) {}

  /// Stands there.
  void start(double angle_rad) {
    angle_rad_ = angle_rad;
    velocity_radps_ = 0.0;
  }
  [[nodiscard]] double angle_rad() const { return angle_rad_; }

  /// The place `elapsed_s` later, on the way to the target, at which it comes to rest.
  double step(double target_rad, double elapsed_s);

 private:
  double speed_radps_;
  double acceleration_radps2_;
  double angle_rad_ = 0.0;
  double velocity_radps_ = 0.0;
};

}  // namespace odoless
