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
                "Share of the matches' standard deviations that remains after the low level.");
    visit.value("sd_m_per_sqrt_m", self.sd_m_per_sqrt_m, Range{0.0, 1.0},
                "Standard deviation of the position after 1 m of travel.");
    visit.value("sd_rad_per_sqrt_m", self.sd_rad_per_sqrt_m, Range{0.0, 1.0},
                "Standard deviation of the heading after 1 m of travel.");
    visit.value("sd_rad_per_sqrt_rad", self.sd_rad_per_sqrt_rad, Range{0.0, 1.0},
                "Standard deviation of the heading after a turn of 1 rad.");
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
    visit.value("particles", self.particles, Range{0, 10'000},
                "Number of particles of the high level; 0: the low level alone.");
    visit.value("segment_updates", self.segment_updates, Range{1, 200},
                "Number of low-level updates in a segment, which is one motion and one observation of the high level.");
    visit.value("scans_weighed", self.scans_weighed, Range{1, 200},
                "Largest number of scans of a segment, evenly selected, that weight the particles; the map takes all.");
    visit.value("beams_used", self.beams_used, Range{1, 16384},
                "Largest number of beams, evenly selected, of such a scan.");
    visit.value("tempering", self.tempering, Range{0.0, 1.0},
                "Exponent of a segment's likelihood, because the errors of its beams are correlated.");
    visit.value("resample_below", self.resample_below, Range{0.0, 1.0},
                "Effective sample size, as a share of the particles, below which the filter resamples.");
    visit.value("wide_share", self.wide_share, Range{0.0, 1.0},
                "Share of the drift samples that are drawn from a wider distribution.");
    visit.value("wide_factor", self.wide_factor, Range{1.0, 20.0}, "Factor by which that distribution is wider.");
    visit.value("refine_steps", self.refine_steps, Range{0, 50},
                "Rounds of a search that refines the drift of each particle in its own map.");
    visit.value("refine_step", self.refine_step, Range{0.01, 3.0},
                "First step of that refinement, in standard deviations.");
    visit.value("free_no_return_m", self.free_no_return_m, Range{0.0, 200.0},
                "Distance up to which a beam without return marks free space in the map; 0: it marks none.");
    visit.value("path_records_max", self.path_records_max, Range{1024, 100'000'000},
                "Most poses of the particles' trajectories; at least 16 segments per particle.");
    visit.group("drift", self.drift, "How far a segment's motion may be off.");
    visit.group("beam", self.beam, "Likelihood of a beam.");
    visit.group("grid", self.grid, "The particles' maps.");
  }
};

}  // namespace odoless
