#pragma once

#include "core/base/parameters.hpp"
#include "core/grid/cell.hpp"
#include "core/grid/grid_walk.hpp"
#include "core/slam/decay.hpp"

namespace odoless {

struct BeamModelParams {
  double sigma_m = 0.05;
  double floor = 0.1;
  double unknown_rho_m = 8.0;
  double unknown_likelihood = 0.7;
  double rho_min_m = 0.02;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("sigma_m", self.sigma_m, Range{0.005, 2.0}, "Standard deviation of a range.");
    visit.value("floor", self.floor, Range{1e-6, 0.9}, "Likelihood of a beam that the map does not explain at all.");
    visit.value("unknown_rho_m", self.unknown_rho_m, Range{0.05, 1000.0},
                "Mean distance that a beam travels in unknown cells.");
    visit.value("unknown_likelihood", self.unknown_likelihood, Range{0.0, 1.0},
                "Likelihood of a beam that ends in unknown cells; 0: as published, by unknown_rho_m.");
    visit.value("rho_min_m", self.rho_min_m, Range{0.0005, 1.0},
                "Smallest mean distance that a beam travels in an occupied cell.");
  }
};

/// How likely a beam is in a map of opacities, and what it adds to one [eliazar2004dpslam2; method 6].
///
/// In a cell with mean travel rho = distance / hits a beam stops within x with probability 1 - exp(-x / rho). The
/// likelihood of a range z sums, over the cells on the beam's way, P(reach) P(stop in the cell) exp(-(z - m)^2 / 2
/// sigma^2) with m the way to the middle of the path in the cell, and is lifted by a uniform floor. Constant factors
/// are left out: they cancel when weights are normalised.
///
/// Beyond the paper: a beam that reaches a cell never seen within 3 sigma of its end counts `unknown_likelihood` for
/// all that lies behind. As published it would count next to nothing, and particles that see less new ground would
/// weigh more.
///
/// `Map` has `at(GridCell)`, which returns the Cell for any column and row.
/// Units:     lengths along a walk are in cells. Thread: immutable. Real time: no allocation, bounded by the walk.
class BeamModel {
 public:
  BeamModel(const BeamModelParams& params, double resolution_m)
      : floor_(static_cast<float>(params.floor)),
        sigmas_per_cell_(static_cast<float>(resolution_m / params.sigma_m)),
        unknown_stops_per_cell_(static_cast<float>(resolution_m / params.unknown_rho_m)),
        unknown_likelihood_(static_cast<float>(params.unknown_likelihood)),
        rho_min_parts_(static_cast<float>(params.rho_min_m / resolution_m * Cell::kParts)) {}

  /// Way beyond a range that a walk must cover for `likelihood`.
  [[nodiscard]] double reach_cells() const { return kSigmas / static_cast<double>(sigmas_per_cell_); }

  /// Likelihood, in (0, 1], of a beam that stopped after `measured_cells`; the walk goes on for `reach_cells`.
  template <class Map>
  [[nodiscard]] float likelihood(Map& map, GridWalk walk, float measured_cells) const {
    const float near_cells = measured_cells - kSigmas / sigmas_per_cell_;
    float depth = 0.0F;  // integral of 1 / rho along the way: P(reach) = exp(-depth)
    float reach = 1.0F;  // once near
    bool near = false;
    float sum = 0.0F;
    do {
      const Cell& cell = map.at(walk.cell());
      if (cell.is_free()) {
        continue;
      }
      const float before = depth;
      if (cell.is_unknown() && unknown_likelihood_ > 0.0F && walk.exit() > near_cells) {
        sum += (near ? reach : decay(before)) * unknown_likelihood_;
        break;
      }
      depth += stops_per_cell(cell) * walk.length_cells();
      if (walk.exit() > near_cells) {
        reach = near ? reach : decay(before);
        near = true;
        const float passed = decay(depth);
        const float middle_cells = 0.5F * (walk.enter() + walk.exit());
        const float sigmas = (measured_cells - middle_cells) * sigmas_per_cell_;
        sum += (reach - passed) * decay(0.5F * sigmas * sigmas);
        reach = passed;
      }
    } while (depth < kOpaque && walk.next());
    return lifted(sum);
  }

  /// Likelihood of a beam that passed all of the walk.
  template <class Map>
  [[nodiscard]] float likelihood_of_passing(Map& map, GridWalk walk) const {
    float depth = 0.0F;
    do {
      const Cell& cell = map.at(walk.cell());
      depth += cell.is_free() ? 0.0F : stops_per_cell(cell) * walk.length_cells();
    } while (depth < kOpaque && walk.next());
    return lifted(decay(depth));
  }

  /// Adds a beam's way to the map, and its stop at the end of the walk if it stopped.
  template <class Map>
  void integrate(Map& map, GridWalk walk, bool stopped) const {
    Cell* cell = nullptr;
    do {
      cell = &map.at(walk.cell());
      cell->pass(walk.length_parts());
    } while (walk.next());
    if (stopped) {
      cell->hit();
    }
  }

 private:
  static constexpr float kSigmas = 3.0F;
  static constexpr float kOpaque = 6.0F;  ///< P(reach) < 0.0025: what lies behind does not count

  [[nodiscard]] float stops_per_cell(const Cell& cell) const {
    return cell.is_unknown() ? unknown_stops_per_cell_ : cell.stops_per_cell(rho_min_parts_);
  }
  [[nodiscard]] float lifted(float likelihood) const { return floor_ + (1.0F - floor_) * likelihood; }

  float floor_;
  float sigmas_per_cell_;
  float unknown_stops_per_cell_;
  float unknown_likelihood_;
  float rho_min_parts_;
};

}  // namespace odoless
