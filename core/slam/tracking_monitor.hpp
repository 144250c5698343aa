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

/// Makes of the scans' fits whether the robot is lost: time of scans that do not fit counts up, of others down.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class TrackingMonitor {
 public:
  explicit TrackingMonitor(const TrackingParams& params) : params_(params) {}

  void reset() { *this = TrackingMonitor(params_); }

  /// @param fit      ScanFit's, in the best particle's map.
  /// @param suspect  Another sign speaks against the pose: see TrackingParams::suspect_fit_min.
  /// @return         Whether the scan fits.
  bool add(double fit, bool suspect, std::int64_t stamp_ns) {
    const bool fits = fit >= (suspect ? params_.suspect_fit_min : params_.fit_min);
    const double span_s =
        started_ ? std::clamp(1e-9 * static_cast<double>(stamp_ns - stamp_ns_), kSpan_min_s, kSpan_max_s) : kSpan_min_s;
    stamp_ns_ = stamp_ns;
    started_ = true;
    poor_s_ = std::clamp(poor_s_ + (fits ? -span_s : span_s), 0.0, params_.lost_after_s);
    poor_scans_ = fits ? std::max(0, poor_scans_ - 1) : std::min(kPoor_scans, poor_scans_ + 1);
    lost_ = lost_ || (poor_s_ >= params_.lost_after_s && poor_scans_ == kPoor_scans);
    return fits;
  }

  [[nodiscard]] Tracking state() const {
    if (lost_) {
      return Tracking::kLost;
    }
    return poor_scans_ > 0 || poor_s_ > 0.0 ? Tracking::kDoubtful : Tracking::kSure;
  }

 private:
  static constexpr double kSpan_min_s = 0.005;  // stamps that are the same or run backwards
  static constexpr double kSpan_max_s = 0.25;   // a hole in the scans says nothing
  static constexpr int kPoor_scans = 3;         // at least

  TrackingParams params_;
  std::int64_t stamp_ns_ = 0;
  double poor_s_ = 0.0;
  int poor_scans_ = 0;
  bool started_ = false;
  bool lost_ = false;
};

}  // namespace odoless
