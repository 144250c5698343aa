#pragma once

#include "core/base/parameters.hpp"
#include "core/grid/ancestry_grid.hpp"
#include "core/motion/scan_matching_motion_model.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// Of the low-level DP-SLAM filter.
struct LslamParams {
  int particles = 200;
  int particles_min = 100;
  double spread_error = 0.1;
  int beams_used = 60;
  int beams_mapped = 200;
  double tempering = 0.5;
  double resample_below = 0.5;
  int refine_steps = 0;
  double refine_step_m = 0.05;
  double refine_step_rad = 0.01;
  bool weigh_no_return = false;
  double free_no_return_m = 0.0;
  int path_records_max = 65536;
  double forget_after_m = 0.0;
  MotionModelParams motion;
  BeamModelParams beam;
  AncestryGridParams grid;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("particles", self.particles, Range{1, 10'000},
                "Most particles, each a hypothesis of trajectory and map.");
    visit.value("particles_min", self.particles_min, Range{1, 10'000},
                "Fewest particles, however little they differ; `particles` where that is less.");
    visit.value("spread_error", self.spread_error, Range{0.0, 1.0},
                "Error that a resampling may leave in the particles' distribution of poses, which decides how many go "
                "on (KLD sampling); smaller is more of them; 0: always all.");
    visit.value("beams_used", self.beams_used, Range{1, 16384},
                "Largest number of beams, evenly selected, that weight the particles.");
    visit.value(
        "beams_mapped", self.beams_mapped, Range{1, 16384},
        "Largest number of beams, evenly selected and others with each update, that go into the particles' maps.");
    visit.value("tempering", self.tempering, Range{0.0, 1.0},
                "Exponent of a scan's likelihood, because the errors of its beams are correlated; 1: as published.");
    visit.value("resample_below", self.resample_below, Range{0.0, 1.0},
                "Effective sample size, as a share of the particles, below which the filter resamples.");
    visit.value("refine_steps", self.refine_steps, Range{0, 50},
                "Rounds of a search that refines the proposal of each particle in its own map; 0: none, as published.");
    visit.value("refine_step_m", self.refine_step_m, Range{0.0005, 1.0}, "First step of the refinement along x and y.");
    visit.value("refine_step_rad", self.refine_step_rad, Range{0.0001, 0.5}, "First step of the refinement in yaw.");
    visit.flag("weigh_no_return", self.weigh_no_return,
               "Whether a beam without return is evidence, in the weights, for free space up to the laser's range.");
    visit.value("free_no_return_m", self.free_no_return_m, Range{0.0, 200.0},
                "Distance up to which a beam without return marks free space in the map; 0: it marks none.");
    visit.value("path_records_max", self.path_records_max, Range{1024, 100'000'000},
                "Most poses of the particles' trajectories; at least 16 per particle; when they are full, older ones "
                "are thinned.");
    visit.value("forget_after_m", self.forget_after_m, Range{0.0, 1e6},
                "Travel after which the filter forgets a part of its map that it has not seen since; the pose graph "
                "keeps it; 0: never.");
    visit.group("motion", self.motion, "Motion model of scan matching.");
    visit.group("beam", self.beam, "Likelihood of a beam.");
    visit.group("grid", self.grid, "The particles' maps.");
  }
};

}  // namespace odoless
