#include "drivers/tilt/tilt_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace odoless {
namespace {

constexpr double kMovedRad = 0.0035;  ///< less may be noise of the encoder
constexpr double kLegSlack = 2.0;     ///< times as long as its speed allows, and ...
constexpr double kLegSlackS = 1.0;    ///< ... this on top, is too long
constexpr int kReactionSamples = 3;   ///< until a command is on its way, obeyed and seen to be

/// How long an axis that does as it is told may stay within m = kMovedRad of where it was last seen to have moved. One
/// that turns round there first brakes within m, from at most sqrt(2 m a) in at most sqrt(2 m / a), and then goes back
/// across 2 m, from rest to rest at worst: on ramps alone in 2 sqrt(2 m / a), or, where it comes to its speed v, in
/// 2 m / v + v / a, with v / a at most sqrt(2 m / a).
std::int64_t longest_still_ns(const TiltParams& params) {
  const double ramps_s = 3.0 * std::sqrt(2.0 * kMovedRad / params.acceleration_radps2);
  const double way_s = 2.0 * kMovedRad / params.speed_radps;
  return std::llround((ramps_s + way_s) * 1e9) + kReactionSamples * params.sample_period_ns;
}

}  // namespace

TiltMotion::TiltMotion(const TiltParams& params)
    : params_(params),
      end_rad_{std::clamp(params.sweep_from_rad, params.limit_min_rad, params.limit_max_rad),
               std::clamp(params.sweep_to_rad, params.limit_min_rad, params.limit_max_rad)},
      stall_timeout_ns_(std::max(params.stall_timeout_ns, longest_still_ns(params))),
      command_(params.at_start) {}

void TiltMotion::start_leg(std::int64_t now_ns) {
  const double distance_rad = has_angle_ ? std::abs(target_rad() - angle_rad_) : 0.0;
  const double shortest_s =
      distance_rad / params_.speed_radps + 2.0 * params_.speed_radps / params_.acceleration_radps2;
  leg_end_ns_ = now_ns + std::llround((kLegSlack * shortest_s + kLegSlackS) * 1e9);
  moved_ns_ = now_ns;
  moved_from_rad_ = angle_rad_;
}

void TiltMotion::command(TiltCommand command, std::int64_t now_ns) {
  if (command != command_) {
    command_ = command;
    start_leg(now_ns);
  }
}

void TiltMotion::start(std::int64_t now_ns) { start_leg(now_ns); }

bool TiltMotion::is_there() const { return has_angle_ && std::abs(target_rad() - angle_rad_) <= params_.tolerance_rad; }

void TiltMotion::on_angle(const TiltSample& sample) {
  const bool is_first = !has_angle_;
  const bool was_there = is_there();
  has_angle_ = true;
  angle_rad_ = sample.angle_rad;
  if (is_first || std::abs(angle_rad_ - moved_from_rad_) >= kMovedRad) {
    moved_from_rad_ = angle_rad_;
    moved_ns_ = std::max(moved_ns_, sample.arrival_ns);
  }
  if (command_ == TiltCommand::kSweep && is_there()) {
    heading_for_ = 1 - heading_for_;
    start_leg(sample.arrival_ns);
  } else if (is_first || (was_there && !is_there())) {
    start_leg(sample.arrival_ns);  // pushed away: it has its time to come back
  }
}

double TiltMotion::target_rad() const { return command_ == TiltCommand::kSweep ? end_rad_[heading_for_] : 0.0; }

bool TiltMotion::is_stalled(std::int64_t now_ns) const {
  if (command_ == TiltCommand::kStop || !has_angle_ || is_there()) {
    return false;
  }
  return now_ns - moved_ns_ >= stall_timeout_ns_ || now_ns >= leg_end_ns_;
}

TiltState TiltMotion::state() const {
  switch (command_) {
    case TiltCommand::kStop:
      return TiltState::kStopped;
    case TiltCommand::kSweep:
      return TiltState::kSweeping;
    case TiltCommand::kLevel:
      break;
  }
  return is_there() ? TiltState::kLevel : TiltState::kMoving;
}

TiltScale::TiltScale(const TiltParams& params, double counts_per_turn, double centre_counts)
    : sign_(params.inverted ? -1.0 : 1.0),
      level_angle_rad_(params.level_angle_rad),
      counts_per_rad_(counts_per_turn / (2.0 * std::numbers::pi)),
      centre_counts_(centre_counts) {}

double TiltScale::angle_rad(std::int32_t position_counts) const {
  const double servo_rad = (static_cast<double>(position_counts) - centre_counts_) / counts_per_rad_;
  return sign_ * (servo_rad - level_angle_rad_);
}

double TiltScale::velocity_radps(double counts_per_s) const { return sign_ * counts_per_s / counts_per_rad_; }

std::int32_t TiltScale::position_counts(double angle_rad) const {
  const double servo_rad = sign_ * angle_rad + level_angle_rad_;
  const double counts = std::round(centre_counts_ + servo_rad * counts_per_rad_);
  constexpr double kMin = std::numeric_limits<std::int32_t>::min();
  constexpr double kMax = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(counts, kMin, kMax));
}

double TiltScale::counts(double radians) const { return radians * counts_per_rad_; }

}  // namespace odoless
