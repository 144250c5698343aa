#pragma once

#include <algorithm>
#include <cstdint>

#include "core/slam/recovery_params.hpp"

namespace odoless {

/// What the filter takes its pose for.
enum class Tracking : std::uint8_t {
  kSure,
  kDoubtful,  ///< scans lately did not fit the map
  kLost       ///< the pose in the map is not known
};

/// What a scan says of the pose.
struct TrackingSigns {
  double fit = 1.0;      ///< ScanFit's, in the best particle's map
  bool suspect = false;  ///< the scene leaves one direction open, or few particles matter
  bool carried = false;  ///< the scan matched the ones before only farther away than a robot moves by itself
  bool torn = false;     ///< the scan did not match the ones before: what was known of the pose ends there
};

/// Makes of the scans' fits whether the robot is lost: time of scans that do not fit counts up, of others down.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class TrackingMonitor {
 public:
  explicit TrackingMonitor(const TrackingParams& params) : params_(params) {}

  void reset() { *this = TrackingMonitor(params_); }

  /// Goes on without having been found: in doubt, whatever fits, until `reset`.
  void resume() {
    reset();
    unconfirmed_ = true;
  }

  void add(const TrackingSigns& signs, std::int64_t stamp_ns) {
    const double span_s =
        started_ ? std::clamp(1e-9 * static_cast<double>(stamp_ns - stamp_ns_), kSpan_min_s, kSpan_max_s) : kSpan_min_s;
    stamp_ns_ = stamp_ns;
    started_ = true;
    fits_ = signs.fit >= bar(signs);
    const bool torn_anew = signs.torn || (torn_s_ > 0.0 && !fits_);
    torn_s_ = torn_anew ? params_.torn_for_s : std::max(0.0, torn_s_ - span_s);
    poor_s_ = std::clamp(poor_s_ + (fits_ ? -span_s : span_s), 0.0, params_.lost_after_s);
    poor_scans_ = fits_ ? std::max(0, poor_scans_ - 1) : std::min(kPoor_scans, poor_scans_ + 1);
    lost_ = lost_ || signs.carried || (poor_s_ >= params_.lost_after_s && poor_scans_ == kPoor_scans);
  }

  /// Whether the last scan may be mapped.
  [[nodiscard]] bool is_trusted() const { return fits_ && torn_s_ == 0.0 && !lost_; }

  [[nodiscard]] Tracking state() const {
    if (lost_) {
      return Tracking::kLost;
    }
    return unconfirmed_ || poor_scans_ > 0 || poor_s_ > 0.0 || torn_s_ > 0.0 ? Tracking::kDoubtful : Tracking::kSure;
  }

 private:
  static constexpr double kSpan_min_s = 0.005;  // stamps that are the same or run backwards
  static constexpr double kSpan_max_s = 0.25;   // a hole in the scans says nothing
  static constexpr int kPoor_scans = 3;         // at least

  [[nodiscard]] double bar(const TrackingSigns& signs) const {
    if (signs.torn || torn_s_ > 0.0) {
      return params_.torn_fit_min;
    }
    return signs.suspect ? params_.suspect_fit_min : params_.fit_min;
  }

  TrackingParams params_;
  std::int64_t stamp_ns_ = 0;
  double torn_s_ = 0.0;  ///< left
  double poor_s_ = 0.0;
  int poor_scans_ = 0;
  bool started_ = false;
  bool fits_ = true;
  bool lost_ = false;
  bool unconfirmed_ = false;
};

}  // namespace odoless
