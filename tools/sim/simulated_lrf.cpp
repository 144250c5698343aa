#include "tools/sim/simulated_lrf.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"
#include "tools/sim/ray_caster.hpp"

namespace odoless {
namespace {

constexpr double kFullCircleRad = 2.0 * std::numbers::pi;
constexpr std::uint64_t kNoiseStream = 0;
constexpr std::uint64_t kLossStream = 1;

double angle_step_rad(const SimulatedLrfParams& params) {
  const bool is_full_circle = params.field_of_view_rad > kFullCircleRad - 1e-9;
  return params.field_of_view_rad / (is_full_circle ? params.beams : params.beams - 1);
}

}  // namespace

SimulatedLrfParams simulated_lrf_params(const LrfModel& model) {
  return {.field_of_view_rad = model.field_of_view_deg * std::numbers::pi / 180.0,
          .beams = model.beams,
          .rate_hz = model.rate_hz,
          .range_max_m = model.range_max_m,
          .noise_sd_m = model.range_sd_m};
}

SimulatedLrf::SimulatedLrf(const SimulatedLrfParams& params, std::uint64_t seed)
    : params_(params),
      angle_step_rad_(odoless::angle_step_rad(params)),
      noise_(seed, kNoiseStream),
      loss_(seed, kLossStream),
      ranges_m_(static_cast<std::size_t>(params.beams)) {
  ODOLESS_CHECK(parameters_in_range(params));
}

double SimulatedLrf::measured_m(double true_m) {
  // Both are drawn for every beam, so that a beam's chance doesn't depend on what the beams before it hit.
  const double noise_m = params_.noise_sd_m * noise_.normal();
  const bool is_lost = loss_.uniform() < params_.no_return_share;
  const double range_m = std::max(0.0, true_m + noise_m);
  return is_lost || true_m > params_.range_max_m || range_m >= params_.range_max_m
             ? std::numeric_limits<double>::infinity()
             : range_m;
}

double SimulatedLrf::beam_period_s() const {
  return params_.distortion ? angle_step_rad_ / kFullCircleRad / params_.rate_hz : 0.0;
}

std::span<const double> SimulatedLrf::sweep(const World& world, const Path& path, double time_s) {
  Pose2 world_T_scan = path.at(time_s);
  const auto true_range_m = [&](double beam_time_s, double angle_rad) {
    if (params_.distortion) {
      world_T_scan = path.at(beam_time_s);
    }
    const double yaw_rad = world_T_scan.yaw_rad + angle_rad;
    return cast_ray_m(world, beam_time_s, {world_T_scan.x_m, world_T_scan.y_m},
                      {math::cos(yaw_rad), math::sin(yaw_rad)});
  };
  return sweep(true_range_m, time_s);
}

std::span<const double> SimulatedLrf::sweep(const TrueRange& true_range_m, double time_s) {
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    const auto beam = static_cast<double>(i);
    ranges_m_[i] =
        measured_m(true_range_m(time_s + beam * beam_period_s(), start_angle_rad() + beam * angle_step_rad_));
  }
  return ranges_m_;
}

}  // namespace odoless
