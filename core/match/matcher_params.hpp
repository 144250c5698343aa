#pragma once

#include "core/base/parameters.hpp"
#include "core/ndt/ndt.hpp"
#include "core/ndt/score_raster.hpp"
#include "core/optimize/differential_evolution.hpp"

namespace odoless {

/// What a reference is made into.
struct ReferenceParams {
  NdtParams ndt{.cell_size_m = 0.7};
  double wide_cell_size_m = 4.0;
  RasterParams fine{.resolution_m = 0.05, .extent_m = 20.0, .sigma_min_m = 0.05};
  RasterParams coarse{.resolution_m = 0.10, .extent_m = 20.0, .sigma_min_m = 0.25};
  double thinning_m = 0.1;
  double free_margin_m = 0.15;
  double free_penalty = 0.7;
  int free_every = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    describe_common(self, visit);
    describe_second_try(self, visit);
    describe_many_scans(self, visit);
  }
  /// Of every reference.
  template <class Self, class Visitor>
  static void describe_common(Self& self, Visitor& visit) {
    visit.group("ndt", self.ndt, "Normal Distributions Transform of the last, exact step.");
    visit.group("fine", self.fine, "Raster of the second half of the search.");
    visit.group("coarse", self.coarse, "Blurred raster of the first half of the search.");
    visit.value(
        "thinning_m", self.thinning_m, Range{0.0, 1.0},
        "Distance between two points along a wall, so that near walls do not outweigh far ones; 0 keeps all points.");
    visit.value("free_margin_m", self.free_margin_m, Range{0.0, 2.0},
                "Distance before the end of a beam up to which it marks free space.");
    visit.value("free_penalty", self.free_penalty, Range{0.0, 1.0},
                "Penalty for a point in the reference's free space; in the fine raster only, because it hinders the "
                "coarse search.");
  }
  template <class Self, class Visitor>
  static void describe_second_try(Self& self, Visitor& visit) {
    visit.value("wide_cell_size_m", self.wide_cell_size_m, Range{0.0, 20.0},
                "Side of an NDT cell in the wide search after a rejected match; 0: the blurred raster is used.");
  }
  template <class Self, class Visitor>
  static void describe_many_scans(Self& self, Visitor& visit) {
    visit.value("free_every", self.free_every, Range{1, 100},
                "Only every Nth scan marks free space; scans that overlap mark the same.");
  }
};

/// A reference of one scan.
struct ScanReferenceParams : ReferenceParams {
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    describe_common(self, visit);
    describe_second_try(self, visit);
  }
};

/// How a search spends its evaluations.
struct SearchParams {
  double box_translation_m = 2.0;
  double box_rotation_rad = 1.4835;
  int start_points = 400;
  double expected_share = 0.5;
  int coarse_evaluations = 750;
  int fine_evaluations = 600;
  int coarse_every = 4;
  bool exact = false;
  double spread_m = 0.5;
  double angle_floor = 0.02;
  int simplex_steps = 60;
  DeParams de{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("box_translation_m", self.box_translation_m, Range{0.01, 50.0}, "Half the side of the search box.");
    visit.value("box_rotation_rad", self.box_rotation_rad, Range{0.001, 3.1416},
                "Half the range of rotation that is searched.");
    visit.value("start_points", self.start_points, Range{8, 10000},
                "Number of start points, of which the best become the first population.");
    visit.value("expected_share", self.expected_share, Range{0.0, 1.0},
                "Share of the start points that are drawn around the expected motion; the others are distributed "
                "evenly over the box.");
    visit.value("coarse_evaluations", self.coarse_evaluations, Range{0, 1000000},
                "Number of evaluations on the blurred raster.");
    visit.value("fine_evaluations", self.fine_evaluations, Range{0, 1000000},
                "Number of evaluations on the fine raster.");
    visit.value("coarse_every", self.coarse_every, Range{1, 100}, "The coarse search uses only every Nth point.");
    visit.flag("exact", self.exact,
               "Whether the search scores the exact NDT of all points instead of the fine raster; ten times slower.");
    visit.value("spread_m", self.spread_m, Range{0.0, 5.0},
                "Standard deviation of the noise on the better half of the population when its copy replaces the worse "
                "half, between coarse and fine search.");
    visit.value("angle_floor", self.angle_floor, Range{0.0, 1.0},
                "Share of the start angles that are distributed evenly instead of by the orientation histograms.");
    visit.value("simplex_steps", self.simplex_steps, Range{0, 1000},
                "Number of evaluations of the downhill simplex after the search.");
    visit.group("de", self.de, "Differential Evolution.");
  }
};

/// The matcher's whole setting.
struct MatcherParams {
  int points_max = 2048;
  ScanReferenceParams reference{};
  SearchParams search{};
  SearchParams retry{.box_translation_m = 4.0,
                     .box_rotation_rad = 3.1416,
                     .start_points = 800,
                     .expected_share = 0.0,
                     .coarse_evaluations = 1200,
                     .fine_evaluations = 900};
  double probe_m = 1.5;
  int refine_steps = 12;
  double score_min = 0.2;
  double prior_weight = 0.1;
  double second_peak_ratio_max = 0.9;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("points_max", self.points_max, Range{16, 100000},
                "Most points of a scan or a reference; a scan with more beams is refused.");
    visit.group("reference", self.reference, "Representation of the reference scan.");
    visit.group("search", self.search, "Search for every scan.");
    visit.group("retry", self.retry, "Wide search after a rejected match, with larger cells.");
    visit.value("probe_m", self.probe_m, Range{0.0, 20.0},
                "Distance from the best pose, along the least constrained direction, at which other hypotheses are "
                "sought; 0: none are.");
    visit.value("refine_steps", self.refine_steps, Range{1, 100}, "Largest number of Newton steps on the exact score.");
    visit.value("score_min", self.score_min, Range{0.0, 1.0},
                "Least mean score per point; a match below it is searched again more widely, and rejected if that does "
                "not help.");
    visit.value("prior_weight", self.prior_weight, Range{0.0, 1.0},
                "Weight of the expected motion: a pose outside its standard deviations loses this times the logarithm "
                "of their squares.");
    visit.value("second_peak_ratio_max", self.second_peak_ratio_max, Range{0.0, 1.0},
                "Score of a second hypothesis, as a share of the best, above which the match is ambiguous.");
  }
};

/// The method in its plainest form (sections 5.1.1 and 5.1.3 of the dissertation): DE/rand/1/bin with N = 100 members
/// and G = 50 generations, spread evenly over the box, on the exact NDT score of every beam with cells of 1 m; nothing
/// coarse, thinned, freed, refined or retried. For comparison.
[[nodiscard]] MatcherParams seed_matcher_params();

}  // namespace odoless
