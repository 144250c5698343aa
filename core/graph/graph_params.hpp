#pragma once

#include "core/base/parameters.hpp"
#include "core/match/matcher_params.hpp"

namespace odoless {

/// What submaps are matched against: as the odometry's local map, but larger, and coarse enough for points from a few
/// metres of travel. Free space contradicts a wrong loop closure [study of 2026: without it 11 wrong ones of 441].
struct SubmapReferenceParams : ReferenceParams {
  SubmapReferenceParams() {
    ndt.cell_size_m = 0.5;
    ndt.extent_m = 29.0;
    free_every = 3;
    wide_cell_size_m = 0.0;  // no match is tried again
    fine.extent_m = coarse.extent_m = 25.0;
  }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    describe_common(self, visit);
    describe_many_scans(self, visit);
  }
};

/// The pose graph of submaps.
struct GraphParams {
  bool enabled = true;
  int submaps_max = 2048;
  int constraints_max = 16384;
  int keyframes_max = 24576;
  int keyframe_beams_max = 541;
  double keyframe_distance_m = 0.4;
  double keyframe_rotation_rad = 0.2618;
  double submap_travel_m = 5.0;
  int submap_keyframes = 20;
  double submap_slip_m = 1.0;
  int candidates = 24;
  int references = 3;
  int reference_points_max = 24000;
  SubmapReferenceParams reference;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.flag("enabled", self.enabled, "Whether loops are closed by a pose graph of submaps.");
    visit.value("submaps_max", self.submaps_max, Range{16, 200'000},
                "Largest number of submaps; memory is set aside for them.");
    visit.value("constraints_max", self.constraints_max, Range{32, 2'000'000},
                "Largest number of constraints between submaps; memory is set aside for them.");
    visit.value("keyframes_max", self.keyframes_max, Range{64, 4'000'000},
                "Largest number of keyframes; memory is set aside for them.");
    visit.value(
        "keyframe_beams_max", self.keyframe_beams_max, Range{32, 16384},
        "Largest number of beams of a keyframe; of a scan with more, only every second, third, ... beam is kept.");
    visit.value("keyframe_distance_m", self.keyframe_distance_m, Range{0.05, 10.0},
                "Travel after which a scan becomes a keyframe.");
    visit.value("keyframe_rotation_rad", self.keyframe_rotation_rad, Range{0.02, 3.1416},
                "Rotation after which a scan becomes a keyframe.");
    visit.value("submap_travel_m", self.submap_travel_m, Range{0.5, 100.0}, "Travel after which a submap ends.");
    visit.value("submap_keyframes", self.submap_keyframes, Range{3, 100}, "Largest number of keyframes of a submap.");
    visit.value("submap_slip_m", self.submap_slip_m, Range{0.1, 10.0},
                "Uncertainty of laser odometry along an unconstrained direction after which a submap ends.");
    visit.value("candidates", self.candidates, Range{1, 200},
                "Largest number of older submaps that a submap is matched with when it ends.");
    visit.value("references", self.references, Range{1, 100},
                "Number of submaps that are kept prepared for matching; each takes some 30 MB.");
    visit.value("reference_points_max", self.reference_points_max, Range{1000, 200'000},
                "Largest number of points of a submap with its neighbours.");
    visit.group("reference", self.reference, "Representation of a submap for matching.");
  }
};

}  // namespace odoless
