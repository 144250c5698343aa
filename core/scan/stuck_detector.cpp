#include "core/scan/stuck_detector.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kSame_share = 0.9;
constexpr double kSame_share_fine = 0.6;
constexpr float kFine_m = 0.005F;
constexpr float kQuiet_share = 0.4F;  // of the quietest scans' change
constexpr int kAccepted_scans = 60;   // in a row, after which so little change is taken for the laser's noise
constexpr float kLeap = 3.0F;         // of the quietest scans' change: a scene that is seen anew after a while
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
  was_stuck_ = repeats_;  // if this one does not
  repeats_ = is_too_quiet_ = false;
  if (changes_m_.size() < kReturns_min) {
    return;
  }
  const auto same = static_cast<double>(std::count(changes_m_.begin(), changes_m_.end(), 0.0F));
  const auto middle = changes_m_.begin() + static_cast<std::ptrdiff_t>(changes_m_.size() / 2);
  std::nth_element(changes_m_.begin(), middle, changes_m_.end());
  for (const float change_m : changes_m_) {
    finest_m_ = change_m > 0.0F ? std::min(finest_m_, change_m) : finest_m_;
  }
  const double same_share = finest_m_ <= kFine_m ? kSame_share_fine : kSame_share;
  repeats_ = same >= same_share * static_cast<double>(changes_m_.size());
  is_too_quiet_ = !repeats_ && is_unlike_its_noise(*middle);
}

bool StuckDetector::is_unlike_its_noise(float change_m) {
  const float recent_m = std::max({change_m, recent_m_[0], recent_m_[1]});
  recent_m_[0] = recent_m_[1];
  recent_m_[1] = change_m;
  if (++scans_ < 3) {
    return false;
  }
  if (quietest_m_ && change_m < kQuiet_share * *quietest_m_) {
    loudest_quiet_m_ = std::max(loudest_quiet_m_, change_m);
    return ++quiet_in_a_row_ < kAccepted_scans;
  }
  const bool has_leapt = quietest_m_ && change_m >= kLeap * *quietest_m_;
  const bool were_live = quiet_in_a_row_ > 0 && !has_leapt;
  was_stuck_ = was_stuck_ || (quiet_in_a_row_ > 0 && has_leapt);
  quietest_m_ = std::min(quietest_m_.value_or(recent_m), were_live ? loudest_quiet_m_ : recent_m);
  quiet_in_a_row_ = 0;
  loudest_quiet_m_ = 0.0F;
  return false;
}

}  // namespace odoless
