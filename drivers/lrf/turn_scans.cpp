#include "drivers/lrf/turn_scans.hpp"

#include <algorithm>
#include <numbers>

#include "core/base/float_precision.hpp"

namespace odoless {
namespace {

constexpr double kKnownShareMin = 0.8;  ///< of the beams of a scan that is passed on

}  // namespace

TurnScans::TurnScans(const LrfGeometry& like, int beams_max, double miss_lag_deg)
    : geometry_(like), nominal_period_ns_(like.period_ns), buffer_(beams_max), turn_(miss_lag_deg) {
  geometry_.start_angle_rad = 0.0;
  geometry_.angle_step_rad = to_float_precision(-2.0 * std::numbers::pi / like.beams);
}

Errc TurnScans::start() {
  if (geometry_.beams > buffer_.beams_max()) {
    return Errc::kTooManyBeams;
  }
  geometry_.period_ns = nominal_period_ns_;
  turn_.clear();
  buffer_.restart();
  return Errc::kOk;
}

FoundScan TurnScans::finish(std::int64_t arrival_ns) {
  const std::span<float> ranges_m = buffer_.next(geometry_.beams);
  const int known = turn_.resample(ranges_m);
  if (turn_.is_spoilt() || known < kKnownShareMin * geometry_.beams) {
    return {.scan = {}, .error = Errc::kWrongCount};
  }
  geometry_.period_ns = std::clamp<std::int64_t>(turn_.period_ns(), 20'000'000, 2'000'000'000);
  last_stamp_ns_ = std::max(turn_.start_ns() / 1000 * 1000, last_stamp_ns_ + 1000);
  return {.scan = LrfScan{.stamp_ns = last_stamp_ns_,
                          .arrival_ns = arrival_ns,
                          .start_angle_rad = geometry_.start_angle_rad,
                          .angle_step_rad = geometry_.angle_step_rad,
                          .beam_period_ns = geometry_.period_ns / geometry_.beams,
                          .ranges_m = buffer_.seal()},
          .error = Errc::kOk};
}

}  // namespace odoless
