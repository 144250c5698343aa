#include "core/slam/recovery.hpp"

#include <algorithm>
#include <optional>

namespace odoless {
namespace {

/// Matched in the narrow search, or then in the wide one.
bool is_accepted(const Motion& motion) { return motion.matched() && !motion.has(kRejected); }

}  // namespace

Recovery::Recovery(const RecoveryParams& params, const ScanParams& scan, const Slam& slam)
    : params_(params),
      monitor_(params.tracking),
      usual_(params.tracking),
      fit_(slam.params().low.beam, params.tracking.fit_sigma_m, slam.low().geometry().resolution_m,
           slam.params().low.beams_used),
      relocaliser_(params.search, params.tracking.fit_sigma_m, scan, slam) {
  ODOLESS_CHECK(parameters_in_range(params));
}

void Recovery::reset() {
  updates_ = 0;
  usual_.reset();
  usual_fit_ = UsualLevel{};
  trust();
}

void Recovery::trust() {
  monitor_.reset();
  last_fit_ = 1.0;
  depleted_ = settled_ = false;
}

void Recovery::note(const UpdateReport& report, int particles) {
  ++updates_;
  depleted_ = report.effective_particles < params_.tracking.depleted_share * particles;
}

Advice Recovery::process(Slam& slam, const TrackedScan& tracked) {
  relocaliser_.move(tracked.motion.previous_T_current);
  if (!params_.enabled) {
    return Advice::kGoOn;
  }
  if (lost()) {
    return look_for_it(slam, tracked);
  }
  // Where scans are far apart nothing of this tells a robot that is lost from one that goes on.
  const bool can_tell = updates_ >= params_.tracking.updates_min && usual_.is_dense();
  const Advice advice = can_tell ? diagnose(slam, tracked) : Advice::kGoOn;
  if (state() == Tracking::kSure) {
    usual_.add(tracked.motion.previous_T_current);
  }
  return advice;
}

Advice Recovery::diagnose(Slam& slam, const TrackedScan& tracked) {
  static_cast<void>(fit_.load(tracked.scan));
  last_fit_ = fit_with(slam.low(), slam.low().best(), tracked.update_T_scan);
  if (last_fit_ < params_.tracking.suspect_fit_min) {
    last_fit_ = best_fit(slam.low(), tracked.update_T_scan);
  }
  monitor_.add(signs_of(tracked), tracked.scan.stamp_ns());
  const double span_s = span_.next_s(tracked.scan.stamp_ns());
  if (state() == Tracking::kSure) {
    usual_fit_.add(last_fit_, span_s);
  }
  if (lost()) {
    relocaliser_.begin(slam.map_T_scan(), params_.tracking.usual_share * usual_fit_.value());
    settled_ = false;
    matched_s_ = 0.0;
  }
  return monitor_.is_trusted() ? Advice::kGoOn : Advice::kHold;
}

double Recovery::fit_with(Lslam& low, int particle, const Pose2& update_T_scan) const {
  return fit_.of(low.map(particle), low.geometry(), low.pose(particle) * update_T_scan);
}

// At a loop the best particle may be wrong and another right: that is for the filter to decide, which needs the scan.
double Recovery::best_fit(Lslam& low, const Pose2& update_T_scan) const {
  double best = 0.0;
  for (int particle = 0; particle < low.particles(); ++particle) {
    best = std::max(best, fit_with(low, particle, update_T_scan));
  }
  return best;
}

TrackingSigns Recovery::signs_of(const TrackedScan& tracked) const {
  const TrackingParams& params = params_.tracking;
  const Motion& motion = tracked.motion;
  const bool is_open = motion.weak_information_1_m2 < params.weak_information_1_m2;
  const bool is_far = motion.has(kEscalated) || usual_.is_too_fast(motion.previous_T_current, motion.duration_s());
  const bool is_poor = last_fit_ < params.usual_share * usual_fit_.value();
  return {.fit = last_fit_,
          .suspect = depleted_ || is_open,
          .carried = is_far && usual_.is_unusual(motion.previous_T_current),
          .torn = !is_accepted(motion) || (motion.has(kJolted) && is_poor),
          .usual_fit = usual_fit_.value()};
}

Advice Recovery::look_for_it(Slam& slam, const TrackedScan& tracked) {
  settled_ = settled_ || slam.settle();
  if (!settled_) {
    return Advice::kHold;
  }
  const std::optional<Pose2> map_T_scan = relocaliser_.process(slam, tracked.scan);
  if (!map_T_scan) {
    if (!has_waited_enough(tracked)) {
      return Advice::kHold;
    }
    monitor_.resume();
    slam.low().forget_speed();
    return Advice::kGoOn;
  }
  slam.set_pose(*map_T_scan, {params_.search.spread_m, params_.search.spread_rad});
  trust();
  monitor_.try_anew();
  return Advice::kFound;
}

bool Recovery::has_waited_enough(const TrackedScan& tracked) {
  matched_s_ = is_accepted(tracked.motion) ? matched_s_ + tracked.motion.duration_s() : 0.0;
  return params_.search.resume_after_s > 0.0 && matched_s_ >= params_.search.resume_after_s;
}

}  // namespace odoless
