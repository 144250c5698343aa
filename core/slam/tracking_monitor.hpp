#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/scan_span.hpp"
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
  double fit = 1.0;        ///< ScanFit's, in the map that it fits best of those that matter
  bool suspect = false;    ///< the scene leaves one direction open, or few particles matter
  bool carried = false;    ///< the scan lies to the ones before farther away than a robot moves by itself
  bool torn = false;       ///< the scan did not match the ones before: what was known of the pose ends there
  double usual_fit = 0.0;  ///< of the scans while the pose was sure
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

  /// The robot was found: as after a tear, until scans have fitted for a while.
  void try_anew() {
    reset();
    torn_s_ = params_.torn_for_s;
  }

  void add(const TrackingSigns& signs, std::int64_t stamp_ns) {
    const double span_s = span_.next_s(stamp_ns);
    fits_ = signs.fit >= bar(signs);
    const bool torn_anew = signs.torn || (torn_s_ > 0.0 && !fits_);
    torn_s_ = torn_anew ? params_.torn_for_s : std::max(0.0, torn_s_ - span_s);
    const double patience_s = torn_s_ > 0.0 ? params_.lost_after_s : params_.contradicted_after_s;
    poor_s_ = std::clamp(poor_s_ + (fits_ ? -span_s : span_s), 0.0, patience_s);
    poor_scans_ = fits_ ? std::max(0, poor_scans_ - 1) : std::min(kPoor_scans, poor_scans_ + 1);
    lost_ = lost_ || signs.carried || (poor_s_ >= patience_s && poor_scans_ == kPoor_scans);
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
  static constexpr int kPoor_scans = 3;  // at least

  [[nodiscard]] double bar(const TrackingSigns& signs) const {
    if (signs.torn || torn_s_ > 0.0) {
      return std::max(params_.torn_fit_min, params_.usual_share * signs.usual_fit);
    }
    return signs.suspect ? params_.suspect_fit_min : params_.fit_min;
  }

  TrackingParams params_;
  ScanSpan span_;
  double torn_s_ = 0.0;  ///< left
  double poor_s_ = 0.0;
  int poor_scans_ = 0;
  bool fits_ = true;
  bool lost_ = false;
  bool unconfirmed_ = false;
};

}  // namespace odoless
