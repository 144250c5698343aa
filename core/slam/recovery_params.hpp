#pragma once

#include "core/base/parameters.hpp"
#include "core/match/global_search.hpp"
#include "core/slam/pose_confidence.hpp"

namespace odoless {

/// How the filter judges its pose. A scan's fit is the mean likelihood of its beams in the best particle's map, from
/// where that particle would have it: 1 if the map explains all of it.
struct TrackingParams {
  double fit_sigma_m = 0.15;
  double fit_min = 0.2;
  double usual_share = 0.75;
  double sure_probability = 0.9;
  double map_probability = 0.5;
  double lost_probability = 0.8;
  double leap_m = 0.6;
  double leap_rad = 0.6;
  int updates_min = 20;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("fit_sigma_m", self.fit_sigma_m, Range{0.01, 2.0},
                "Deviation of a range from the map at which a beam still half fits.");
    visit.value("fit_min", self.fit_min, Range{0.0, 1.0},
                "A scan that fits no particle's map better than this is not mapped.");
    visit.value("usual_share", self.usual_share, Range{0.0, 1.0},
                "Share of the usual fit that a candidate must reach to be the robot's pose.");
    visit.value("sure_probability", self.sure_probability, Range{0.5, 1.0},
                "The state is OK where the pose is right with at least this probability.");
    visit.value("map_probability", self.map_probability, Range{0.0, 1.0},
                "Nothing is mapped where the probability that tracking went on is less.");
    visit.value("lost_probability", self.lost_probability, Range{0.5, 1.0},
                "Tracking is lost where it broke off with at least this probability.");
    visit.value("leap_m", self.leap_m, Range{0.0, 10.0},
                "Where steps from scan to scan are usually larger than this, scans are too far apart to tell a robot "
                "that is lost.");
    visit.value("leap_rad", self.leap_rad, Range{0.0, 3.2}, "The same of a turn.");
    visit.value("updates_min", self.updates_min, Range{1, 1'000'000},
                "Updates of the filter before which its map is too small to be lost in.");
  }
};

/// How a lost robot is sought in the map, and when it is found.
struct RelocaliserParams {
  GlobalSearchParams global;
  double evaluations_per_s = 500'000.0;
  double found_fit = 0.6;
  double rival_ratio = 0.85;
  double found_after_s = 2.0;
  double give_up_after_s = 4.0;
  double resume_after_s = 20.0;
  double spread_m = 0.05;
  double spread_rad = 0.015;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("global", self.global, "Where it may be, by one scan.");
    visit.value("evaluations_per_s", self.evaluations_per_s, Range{1000.0, 1e8},
                "Poses looked at per second of scans: what a scan's slice of the search may cost.");
    visit.value("found_fit", self.found_fit, Range{0.0, 1.0}, "Mean fit of a candidate that can be the robot.");
    visit.value("rival_ratio", self.rival_ratio, Range{0.0, 1.0},
                "Another candidate that fits this share of the best leaves the robot lost.");
    visit.value("found_after_s", self.found_after_s, Range{0.0, 60.0}, "Time for which candidates are followed.");
    visit.value("give_up_after_s", self.give_up_after_s, Range{0.1, 600.0},
                "Time after which the search begins anew where candidates stay as good as each other.");
    visit.value("resume_after_s", self.resume_after_s, Range{0.0, 1e6},
                "Time of scans that match each other after which a robot that was not found goes on from where its "
                "odometry has it, in doubt until it is found or told; 0: never.");
    visit.value("spread_m", self.spread_m, Range{0.0, 5.0}, "Deviation of the particles where the robot is found.");
    visit.value("spread_rad", self.spread_rad, Range{0.0, 1.0}, "The same of their yaw.");
  }
};

/// Self-diagnosis of the filter, and the way back.
struct RecoveryParams {
  bool enabled = true;
  TrackingParams tracking;
  ConfidenceParams confidence;
  RelocaliserParams search;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.flag("enabled", self.enabled, "Whether the filter may take itself for lost, and look for itself in the map.");
    visit.group("tracking", self.tracking, "From when on the robot is lost.");
    visit.group("confidence", self.confidence, "How the probability that the pose is right goes and comes.");
    visit.group("search", self.search, "How it is sought in the map.");
  }
};

}  // namespace odoless
