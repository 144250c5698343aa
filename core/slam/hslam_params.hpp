#pragma once

#include <numbers>

#include "core/base/parameters.hpp"
#include "core/grid/ancestry_grid.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// How far a segment's motion may be off: variances that grow with the way, each step's on its own.
struct DriftParams {
  double match_ratio = 1.0;
  double sd_m_per_sqrt_m = 0.02;
  double sd_rad_per_sqrt_m = 0.25 * std::numbers::pi / 180.0;
  double sd_rad_per_sqrt_rad = 0.01;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("match_ratio", self.match_ratio, Range{0.0, 10.0},
                "Share of the matches' own deviations that the low level leaves.");
    visit.value("sd_m_per_sqrt_m", self.sd_m_per_sqrt_m, Range{0.0, 1.0}, "Deviation of the position after 1 m.");
    visit.value("sd_rad_per_sqrt_m", self.sd_rad_per_sqrt_m, Range{0.0, 1.0}, "Deviation of the heading after 1 m.");
    visit.value("sd_rad_per_sqrt_rad", self.sd_rad_per_sqrt_rad, Range{0.0, 1.0},
                "Deviation of the heading after a turn of 1 rad.");
  }
};

/// Of the high-level DP-SLAM filter.
struct HslamParams {
  int particles = 0;
  int segment_updates = 20;
  int scans_weighed = 5;
  int beams_used = 60;
  double tempering = 0.05;
  double resample_below = 0.5;
  double wide_share = 0.1;
  double wide_factor = 3.0;
  int refine_steps = 4;
  double refine_step = 0.5;
  double free_no_return_m = 0.0;
  int path_records_max = 131072;
  DriftParams drift;
  BeamModelParams beam{.sigma_m = 0.1};
  AncestryGridParams grid;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("particles", self.particles, Range{0, 10'000}, "Hypotheses of the run; 0: the low level alone.");
    visit.value("segment_updates", self.segment_updates, Range{1, 200},
                "Updates of the low level that make one motion and one observation of the high level.");
    visit.value("scans_weighed", self.scans_weighed, Range{1, 200},
                "Most scans of a segment that weigh the particles, evenly picked; the map takes all.");
    visit.value("beams_used", self.beams_used, Range{1, 16384}, "Most beams of such a scan, evenly picked.");
    visit.value("tempering", self.tempering, Range{0.0, 1.0},
                "Exponent of a segment's likelihood, since its beams err together.");
    visit.value("resample_below", self.resample_below, Range{0.0, 1.0},
                "Share of the particles; with fewer effective ones the filter resamples.");
    visit.value("wide_share", self.wide_share, Range{0.0, 1.0}, "Share of the draws of the drift that are wider.");
    visit.value("wide_factor", self.wide_factor, Range{1.0, 20.0}, "How many times wider they are.");
    visit.value("refine_steps", self.refine_steps, Range{0, 50},
                "Rounds of a search for a better drift around each draw, in the particle's own map.");
    visit.value("refine_step", self.refine_step, Range{0.01, 3.0}, "First step of that search, in deviations.");
    visit.value("free_no_return_m", self.free_no_return_m, Range{0.0, 200.0},
                "Way that a beam without return clears in the map; 0: it says nothing.");
    visit.value("path_records_max", self.path_records_max, Range{1024, 100'000'000},
                "Pool of poses of the particles' paths; at least 16 segments per particle.");
    visit.group("drift", self.drift, "How far a segment's motion may be off.");
    visit.group("beam", self.beam, "Likelihood of a beam.");
    visit.group("grid", self.grid, "The particles' maps.");
  }
};

}  // namespace odoless
