#include "core/scan/stuck_detector.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kSame_share = 0.9;
constexpr float kQuiet_share = 0.4F;  // of the quietest scans' change
constexpr int kAccepted_scans = 60;   // in a row, after which so little change is what the laser's noise is
constexpr std::size_t kReturns_min = 8;

bool is_range(float range_m) { return std::isfinite(range_m) && range_m > 0.0F; }

}  // namespace

StuckDetector::StuckDetector(int beams_max) {
  last_m_.reserve(static_cast<std::size_t>(beams_max));
  changes_m_.reserve(static_cast<std::size_t>(beams_max));
}

void StuckDetector::add(std::span<const float> ranges_m) {
  ranges_m = ranges_m.first(std::min(ranges_m.size(), last_m_.capacity()));
  changes_m_.clear();
  const bool is_comparable = ranges_m.size() == last_m_.size();
  for (std::size_t i = 0; is_comparable && i < ranges_m.size(); ++i) {
    if (is_range(ranges_m[i]) && is_range(last_m_[i])) {
      changes_m_.push_back(std::abs(ranges_m[i] - last_m_[i]));
    }
  }
  last_m_.assign(ranges_m.begin(), ranges_m.end());
  repeats_ = is_too_quiet_ = false;
  if (changes_m_.size() < kReturns_min) {
    return;
  }
  const auto same = static_cast<double>(std::count(changes_m_.begin(), changes_m_.end(), 0.0F));
  const auto middle = changes_m_.begin() + static_cast<std::ptrdiff_t>(changes_m_.size() / 2);
  std::nth_element(changes_m_.begin(), middle, changes_m_.end());
  repeats_ = same >= kSame_share * static_cast<double>(changes_m_.size());
  is_too_quiet_ = is_unlike_its_noise(*middle);
}

bool StuckDetector::is_unlike_its_noise(float change_m) {
  const float recent_m = std::max({change_m, recent_m_[0], recent_m_[1]});
  recent_m_[0] = recent_m_[1];
  recent_m_[1] = change_m;
  if (++scans_ < 3) {
    return false;
  }
  if (quietest_m_ && change_m < kQuiet_share * *quietest_m_ && ++quiet_in_a_row_ < kAccepted_scans) {
    return true;
  }
  quiet_in_a_row_ = 0;
  quietest_m_ = std::min(quietest_m_.value_or(recent_m), recent_m);
  return false;
}

}  // namespace odoless
