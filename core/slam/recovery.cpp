#include "core/slam/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace odoless {
namespace {

constexpr double kSuspect = 0.05;        // probability of a jump from which on another place is looked for
constexpr double kElsewhere_min = 0.01;  // that a step was wrong, for a place that the steps do not lead to
constexpr double kAmbiguous =
    0.7;  // weight of a motion against its alternatives below which it is taken for one of them
constexpr double kKnown_min = 0.2;  // share of beams below which a fit in what is known tells little

/// How far from the scan before a scan was taken: 1 where it is a new one.
double moved(const Motion& motion) {
  constexpr double kTravel_m = 0.3;
  constexpr double kTurn_rad = 0.3;
  const Pose2& step = motion.previous_T_current;
  return step.distance_m({}) / kTravel_m + std::abs(step.yaw_rad) / kTurn_rad;
}

/// Matched in the narrow search, or then in the wide one.
bool is_accepted(const Motion& motion) { return motion.matched() && !motion.has(kRejected); }

}  // namespace

Recovery::Recovery(const RecoveryParams& params, const ScanParams& scan, const Slam& slam)
    : params_(params),
      confidence_(params.confidence),
      usual_(params.tracking),
      fit_(slam.params().low.beam, params.tracking.fit_sigma_m, slam.low().geometry().resolution_m,
           slam.params().low.beams_used),
      relocaliser_(params.search, params.tracking.fit_sigma_m, scan, slam) {
  ODOLESS_CHECK(parameters_in_range(params));
}

void Recovery::reset() {
  updates_ = 0;
  unsure_s_ = 0.0;
  usual_.reset();
  usual_fit_ = UsualLevel{kFit_memory_s};
  trust();
}

void Recovery::trust() {
  confidence_.reset();
  last_fit_ = Fit{};
  lost_ = unconfirmed_ = suspected_ = settled_ = false;
  unknown_s_ = 0.0;
}

void Recovery::note_update(double within) {
  ++updates_;
  confidence_.slip(within);
}

Tracking Recovery::state(double agreement) const {
  if (lost_) {
    return Tracking::kLost;
  }
  const bool is_sure = !suspected_ && agreement * confidence_.right() >= params_.tracking.sure_probability;
  return is_sure ? Tracking::kSure : Tracking::kDoubtful;
}

Advice Recovery::process(Slam& slam, const TrackedScan& tracked) {
  relocaliser_.move(tracked.motion.previous_T_current);
  if (!params_.enabled) {
    return Advice::kGoOn;
  }
  const Advice advice = lost() ? look_for_it(slam, tracked) : follow(slam, tracked);
  unsure_s_ += std::max(0.0, tracked.motion.duration_s());
  unknown_s_ = advice == Advice::kFound ? unsure_s_ : 0.0;
  unsure_s_ = state() == Tracking::kSure ? 0.0 : unsure_s_;
  return advice;
}

// Where scans are far apart nothing of this tells a robot that is lost from one that goes on.
Advice Recovery::follow(Slam& slam, const TrackedScan& tracked) {
  const Advice advice = usual_.is_dense() ? diagnose(slam, tracked) : Advice::kGoOn;
  if (state() == Tracking::kSure) {
    usual_.add(tracked.motion.previous_T_current);
  }
  return advice;
}

Advice Recovery::diagnose(Slam& slam, const TrackedScan& tracked) {
  static_cast<void>(fit_.load(tracked.scan));
  last_fit_ = fit_of(slam.low(), tracked.update_T_scan);
  const double span_s = span_.next_s(tracked.scan.stamp_ns());
  const Motion& motion = tracked.motion;
  confidence_.move(motion.probability, motion.previous_T_current.distance_m({}), motion.duration_s());
  const double usual = usual_fit_.value();
  confidence_.observe(usual > 0.0 ? last_fit_.in_known / usual : 1.0, last_fit_.known_share, span_s, moved(motion));
  if (state() == Tracking::kSure && last_fit_.known_share > kKnown_min) {
    usual_fit_.add(last_fit_.in_known, span_s);
  }
  if (is_suspect(motion) && !suspected_) {
    suspected_ = true;
    relocaliser_.begin(slam, params_.tracking.usual_share * usual_fit_.value());
  }
  if (suspected_) {
    verify(slam, tracked);
  }
  const bool can_be_lost = updates_ >= params_.tracking.updates_min;
  if (can_be_lost && confidence_.jumped() >= params_.tracking.lost_probability) {
    lose();
  }
  return may_be_mapped() ? Advice::kGoOn : Advice::kHold;
}

bool Recovery::is_suspect(const Motion& motion) const {
  return motion.has(kJolted) || motion.weight() < kAmbiguous || confidence_.jumped() >= kSuspect;
}

void Recovery::verify(Slam& slam, const TrackedScan& tracked) {
  const Pose2 believed_map_T_scan = slam.map_T_scan() * tracked.update_T_scan;
  const std::optional<Pose2> map_T_scan = relocaliser_.process(slam, tracked.scan, believed_map_T_scan);
  if (!map_T_scan) {
    return;
  }
  if (clearly_apart(to_search_point(*map_T_scan), to_search_point(believed_map_T_scan))) {
    if (may_be_elsewhere()) {
      confidence_.contradict();
    }
  } else {
    suspected_ = false;
    confidence_.confirm();
  }
}

// Where every step was right the map has drifted: it lacks the right place, but it may have a twin of it.
bool Recovery::may_be_elsewhere() const { return confidence_.wrong_step() >= kElsewhere_min; }

void Recovery::lose() {
  lost_ = true;
  suspected_ = settled_ = false;
  matched_s_ = 0.0;
}

bool Recovery::may_be_mapped() const {
  return !lost_ && last_fit_.mean >= params_.tracking.fit_min &&
         1.0 - confidence_.jumped() >= params_.tracking.map_probability;
}

// At a loop the best particle may be wrong and another right: that is for the filter to decide, which needs the scan.
Fit Recovery::fit_of(Lslam& low, const Pose2& update_T_scan) const {
  const auto with = [&](int particle) {
    return fit_.in_full(low.map(particle), low.geometry(), low.pose(particle) * update_T_scan);
  };
  Fit best = with(low.best());
  if (best.mean < params_.tracking.fit_min) {
    for (int particle = 0; particle < low.particles(); ++particle) {
      const Fit fit = with(particle);
      best = fit.mean > best.mean ? fit : best;
    }
  }
  return best;
}

Advice Recovery::look_for_it(Slam& slam, const TrackedScan& tracked) {
  settled_ = settled_ || slam.settle();
  if (!settled_) {
    return Advice::kHold;
  }
  const std::optional<Pose2> map_T_scan = relocaliser_.process(slam, tracked.scan, std::nullopt);
  if (!map_T_scan || !may_be_elsewhere()) {
    if (!has_waited_enough(tracked)) {
      return Advice::kHold;
    }
    confidence_.lose_track();
    unconfirmed_ = true;
    ++resumptions_;
    lost_ = false;
    slam.low().forget_speed();
    return Advice::kGoOn;
  }
  find_at(slam, *map_T_scan);
  return Advice::kFound;
}

void Recovery::find_at(Slam& slam, const Pose2& map_T_scan) {
  slam.set_pose(map_T_scan, {params_.search.spread_m, params_.search.spread_rad});
  trust();
  confidence_.find();
}

bool Recovery::has_waited_enough(const TrackedScan& tracked) {
  matched_s_ = is_accepted(tracked.motion) ? matched_s_ + tracked.motion.duration_s() : 0.0;
  return params_.search.resume_after_s > 0.0 && matched_s_ >= params_.search.resume_after_s;
}

}  // namespace odoless
