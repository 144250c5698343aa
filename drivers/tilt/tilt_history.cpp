#include "drivers/tilt/tilt_history.hpp"

#include <cmath>

namespace odoless {

bool TiltHistory::add(std::int64_t stamp_ns, double angle_rad) {
  if (!std::isfinite(angle_rad) || (count_ > 0 && stamp_ns <= at(count_ - 1).stamp_ns)) {
    return false;
  }
  samples_[(first_ + count_) % kSamples] = {stamp_ns, angle_rad};
  if (count_ < kSamples) {
    ++count_;
  } else {
    first_ = (first_ + 1) % kSamples;
  }
  return true;
}

Result<double> TiltHistory::angle_rad(std::int64_t stamp_ns) const {
  if (count_ == 0 || stamp_ns > at(count_ - 1).stamp_ns) {
    return Errc::kNotYet;
  }
  if (stamp_ns < at(0).stamp_ns) {
    return Errc::kTooOld;
  }
  std::size_t before = 0;          // its stamp is not later than the one asked for ...
  std::size_t after = count_ - 1;  // ... and that of this one not earlier
  while (after - before > 1) {
    const std::size_t middle = before + (after - before) / 2;
    (at(middle).stamp_ns <= stamp_ns ? before : after) = middle;
  }
  const Sample& left = at(before);
  const Sample& right = at(after);
  if (stamp_ns == left.stamp_ns || stamp_ns == right.stamp_ns) {
    return stamp_ns == left.stamp_ns ? left.angle_rad : right.angle_rad;
  }
  const std::int64_t gap_ns = right.stamp_ns - left.stamp_ns;
  if (gap_ns > gap_max_ns_) {
    return Errc::kGap;
  }
  const double share = static_cast<double>(stamp_ns - left.stamp_ns) / static_cast<double>(gap_ns);
  return left.angle_rad + share * (right.angle_rad - left.angle_rad);
}

}  // namespace odoless
