#include "drivers/lrf/rplidar/turn.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/lrf/sort_nearly_sorted.hpp"

namespace odoless::rplidar {
namespace {

constexpr double kNeighbours = 1.5;    ///< beams or samples
constexpr double kLostSamples = 16.0;  ///< too few for a time: some were lost, half a capsule at least, not missed
constexpr double kSurfaceRatio = 0.1;

}  // namespace

Turn::Turn(double miss_lag_deg) : miss_lag_deg_(miss_lag_deg), samples_(kPointsMax), finished_(kPointsMax) {}

void Turn::clear() {
  count_ = 0;
  finished_count_ = 0;
  is_whole_ = false;
  is_spoilt_ = false;
}

void Turn::close() {
  const Sample& first = samples_[0];
  const Sample& last = samples_[count_ - 1];
  const double turned_deg = std::max(last.angle_deg - first.angle_deg, 1.0);
  const double ns_per_deg = static_cast<double>(last.time_ns - first.time_ns) / turned_deg;
  const auto steps = static_cast<double>(std::max<std::size_t>(count_ + last.misses - first.misses, 2) - 1);
  complete_ = {.is_whole = is_whole_,
               .is_spoilt = is_spoilt_,
               .start_ns = first.time_ns - std::llround(first.angle_deg * ns_per_deg),
               .period_ns = std::llround(kTurnDeg * ns_per_deg),
               .sample_deg = turned_deg / steps,
               .sample_ns = static_cast<double>(last.time_ns - first.time_ns) / steps};
  samples_.swap(finished_);
  finished_count_ = count_;
  count_ = 0;
  is_whole_ = true;
  is_spoilt_ = false;
  last_deg_ -= kTurnDeg;
  for (std::size_t i = finished_count_ - std::min<std::size_t>(finished_count_, 2); i < finished_count_; ++i) {
    Sample sample = finished_[i];
    sample.angle_deg -= kTurnDeg;
    push(sample);
  }
}

// On a straight line, the reciprocal of the range is nearly linear in a small angle.
inline float Turn::between_m(const Sample& left, const Sample& right, double angle_deg, double beam_deg) const {
  const double gap_deg = right.angle_deg - left.angle_deg;
  double misses = 0.0;
  if (gap_deg > kNeighbours * complete_.sample_deg) {  // what is missed between points in a row was missed elsewhere
    misses = static_cast<double>(std::max(left.misses, right.misses) - std::min(left.misses, right.misses));
    const double apart_ns = std::abs(static_cast<double>(right.time_ns - left.time_ns));
    const bool are_neighbours =
        misses > 0.0 ? apart_ns < (misses + kLostSamples) * complete_.sample_ns : gap_deg <= kNeighbours * beam_deg;
    if (!are_neighbours) {
      return 0.0F;
    }
  }
  const double from_left_deg = angle_deg - left.angle_deg;
  const bool is_one_surface =
      misses == 0.0 && left.range_m > 0.0 && right.range_m > 0.0 &&
      std::abs(left.range_m - right.range_m) < kSurfaceRatio * std::min(left.range_m, right.range_m);
  if (is_one_surface && gap_deg > 0.0) {
    const double weighted = (gap_deg - from_left_deg) * right.range_m + from_left_deg * left.range_m;
    return static_cast<float>(left.range_m * right.range_m * gap_deg / weighted);
  }
  const double share = from_left_deg / std::max(gap_deg, 1e-9);
  const double samples = share * (misses + 1.0);  // from the left one
  const bool is_missed = samples > 0.5 && samples < misses + 0.5;
  const Sample& nearer = share < 0.5 ? left : right;
  return is_missed || nearer.range_m <= 0.0 ? std::numeric_limits<float>::infinity()
                                            : static_cast<float>(nearer.range_m);
}

int Turn::resample(std::span<float> ranges_m) {
  sort_nearly_sorted(std::span(finished_).first(finished_count_),
                     [](const Sample& a, const Sample& b) { return a.angle_deg < b.angle_deg; });
  const double beam_deg = kTurnDeg / static_cast<double>(ranges_m.size());
  int known = 0;
  std::size_t right = 1;
  for (std::size_t beam = 0; beam < ranges_m.size(); ++beam) {
    const double angle_deg = static_cast<double>(beam) * beam_deg;
    while (right < finished_count_ && finished_[right].angle_deg < angle_deg) {
      ++right;
    }
    const bool has_both = right < finished_count_ && finished_[right - 1].angle_deg <= angle_deg;
    ranges_m[beam] = has_both ? between_m(finished_[right - 1], finished_[right], angle_deg, beam_deg) : 0.0F;
    known += ranges_m[beam] > 0.0F ? 1 : 0;
  }
  return known;
}

}  // namespace odoless::rplidar
