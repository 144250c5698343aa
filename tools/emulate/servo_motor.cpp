#include "tools/emulate/servo_motor.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kStepS = 0.5e-3;
constexpr int kStepsMax = 20'000;
constexpr double kThereCounts = 0.5;

}  // namespace

void ServoMotor::set_profile(double speed_counts_per_s, double slope_counts_per_s2) {
  speed_counts_per_s_ = std::max(speed_counts_per_s, 1e-3);
  slope_counts_per_s2_ = std::max(slope_counts_per_s2, 1e-3);
}

void ServoMotor::go_to(double target_counts) {
  target_counts_ = target_counts;
  stopping_ = false;
}

void ServoMotor::stop(double slope_counts_per_s2) {
  stopping_ = true;
  slope_counts_per_s2_ = std::max(slope_counts_per_s2, 1e-3);
}

void ServoMotor::halt() {
  velocity_counts_per_s_ = 0.0;
  target_counts_ = position_counts_;
  stopping_ = false;
}

void ServoMotor::push(double way_counts) {
  position_counts_ += way_counts;
  halt();
}

void ServoMotor::rename(double position_counts) {
  position_counts_ = position_counts;
  halt();
}

bool ServoMotor::is_there() const {
  return std::abs(target_counts_ - position_counts_) <= kThereCounts && velocity_counts_per_s_ == 0.0;
}

void ServoMotor::step(double elapsed_s) {
  const double change = slope_counts_per_s2_ * elapsed_s;
  const double left_counts = target_counts_ - position_counts_;
  // The speed from which the slope just stops it at the target.
  const double stoppable = std::sqrt(2.0 * slope_counts_per_s2_ * std::abs(left_counts));
  const double wished = stopping_ ? 0.0 : std::copysign(std::min(stoppable, speed_counts_per_s_), left_counts);
  velocity_counts_per_s_ += std::clamp(wished - velocity_counts_per_s_, -change, change);
  const double way_counts = velocity_counts_per_s_ * elapsed_s;
  const bool arrives = !stopping_ && std::abs(velocity_counts_per_s_) <= 2.0 * change &&
                       std::abs(left_counts) <= std::max(std::abs(way_counts), 1e-9);
  if (arrives) {
    position_counts_ = target_counts_;
    velocity_counts_per_s_ = 0.0;
  } else {
    position_counts_ += way_counts;
  }
  if (stopping_ && velocity_counts_per_s_ == 0.0) {
    target_counts_ = position_counts_;
  }
}

void ServoMotor::advance(double elapsed_s) {
  if (jammed_) {
    velocity_counts_per_s_ = 0.0;
    return;
  }
  const int steps = std::clamp(static_cast<int>(std::ceil(elapsed_s / kStepS)), 0, kStepsMax);
  for (int i = 0; i < steps; ++i) {
    step(elapsed_s / steps);
  }
}

}  // namespace odoless
