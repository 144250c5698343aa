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
                "Standard deviation of a range in the comparison of a scan with the map.");
    visit.value("fit_min", self.fit_min, Range{0.0, 1.0},
                "Least fit of a scan, in the map of any particle, with which it is mapped.");
    visit.value("usual_share", self.usual_share, Range{0.0, 1.0},
                "Least fit, as a share of the usual fit, of a candidate for the robot's pose.");
    visit.value("sure_probability", self.sure_probability, Range{0.5, 1.0},
                "The state is OK from this probability on that the pose is right.");
    visit.value("map_probability", self.map_probability, Range{0.0, 1.0},
                "Nothing is mapped below this probability that tracking was kept.");
    visit.value("lost_probability", self.lost_probability, Range{0.5, 1.0},
                "Tracking counts as lost from this probability on that it broke off.");
    visit.value("leap_m", self.leap_m, Range{0.0, 10.0},
                "Usual motion from scan to scan above which scans are too far apart to detect lost tracking.");
    visit.value("leap_rad", self.leap_rad, Range{0.0, 3.2},
                "Usual rotation from scan to scan above which scans are too far apart to detect lost tracking.");
    visit.value("updates_min", self.updates_min, Range{1, 1'000'000},
                "Number of filter updates before tracking can be lost; the map is too small until then.");
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
    visit.group("global", self.global, "Global localisation by one scan.");
    visit.value("evaluations_per_s", self.evaluations_per_s, Range{1000.0, 1e8},
                "Evaluations of the search per second of scans: bounds its CPU time per scan.");
    visit.value("found_fit", self.found_fit, Range{0.0, 1.0},
                "Least mean fit of a candidate that is accepted as the robot's pose.");
    visit.value("rival_ratio", self.rival_ratio, Range{0.0, 1.0},
                "Fit of a second candidate, as a share of the best, above which the place is ambiguous and tracking "
                "stays lost.");
    visit.value("found_after_s", self.found_after_s, Range{0.0, 60.0},
                "Time for which candidates are followed before one is accepted.");
    visit.value("give_up_after_s", self.give_up_after_s, Range{0.1, 600.0},
                "Time after which an ambiguous search is repeated.");
    visit.value(
        "resume_after_s", self.resume_after_s, Range{0.0, 1e6},
        "Time of good matches after which a robot that could not be relocalised continues from laser odometry, "
        "in state DEGRADED until a loop closure says where it is, it is relocalised or its pose is set; 0: never.");
    visit.value("spread_m", self.spread_m, Range{0.0, 5.0},
                "Standard deviation of the particles after relocalisation, along x and y.");
    visit.value("spread_rad", self.spread_rad, Range{0.0, 1.0},
                "Standard deviation of the particles after relocalisation, in yaw.");
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
    visit.flag("enabled", self.enabled, "Whether the filter detects that tracking is lost, and relocalises.");
    visit.group("tracking", self.tracking, "When tracking is lost.");
    visit.group("confidence", self.confidence, "Probability that the pose is right.");
    visit.group("search", self.search, "Relocalisation.");
  }
};

}  // namespace odoless
