#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/grid/grid_geometry.hpp"
#include "core/slam/scan_beams.hpp"

namespace odoless {

/// How a scan lies in a map.
struct Fit {
  double mean = 1.0;       ///< likelihood of the beams; one that ends in what was never seen counts the model's share
  double known_share = 0;  ///< of the beams, that the map says anything of
  double in_known = 1.0;   ///< mean likelihood of these; 1 if there are none
};

/// How well a scan fits a map from a pose: the mean likelihood of its beams, from 0, where the map contradicts all of
/// them, to 1. The model is wider than the filter's, since a pose between two updates is off by centimetres.
///
/// Thread: owned by one thread. Real time: no allocation after construction; bounded by the beams and their length.
class ScanFit {
 public:
  /// @param beam        The filter's model, of which it takes all but the deviation and the floor.
  /// @param beams_used  Most beams that are looked at, evenly picked.
  ScanFit(BeamModelParams beam, double sigma_m, double resolution_m, int beams_used)
      : model_(widened(beam, sigma_m), resolution_m),
        known_model_(of_the_known(beam, sigma_m), resolution_m),
        unknown_likelihood_(beam.unknown_likelihood),
        cells_per_m_(1.0 / resolution_m),
        beams_used_(beams_used) {
    beams_.reserve(static_cast<std::size_t>(beams_used));
  }

  /// Takes the scan that is asked about from now on. @return  Its beams that count.
  int load(const ScanFrame& scan) {
    select_beams(scan, beams_used_, false, beams_);
    return static_cast<int>(beams_.size());
  }

  /// Of the loaded scan; 1 if none of its beams counts, since nothing speaks against the pose.
  template <class Map>
  [[nodiscard]] double of(Map&& map, const GridGeometry& grid, const Pose2& map_T_scan) const {
    const BeamCaster caster(grid, map_T_scan);
    double sum = 0.0;
    for (const Beam& beam : beams_) {
      sum += static_cast<double>(likelihood(model_, caster, map, beam, cells_per_m_));
    }
    return beams_.empty() ? 1.0 : sum / static_cast<double>(beams_.size());
  }

  /// The same in full, for twice the time.
  template <class Map>
  [[nodiscard]] Fit in_full(Map&& map, const GridGeometry& grid, const Pose2& map_T_scan) const {
    const double mean = of(map, grid, map_T_scan);
    const BeamCaster caster(grid, map_T_scan);
    double explained = 0.0;
    for (const Beam& beam : beams_) {
      explained += static_cast<double>(likelihood(known_model_, caster, map, beam, cells_per_m_));
    }
    explained /= std::max<double>(1.0, static_cast<double>(beams_.size()));
    const double unknown = beams_.empty() ? 1.0 : (mean - explained) / std::max(1e-3, unknown_likelihood_);
    const double known = std::clamp(1.0 - unknown, 0.0, 1.0);
    return {mean, known, known > 0.0 ? std::min(1.0, explained / known) : 1.0};
  }

 private:
  static BeamModelParams widened(BeamModelParams beam, double sigma_m) {
    beam.sigma_m = sigma_m;
    beam.floor = 1e-6;
    return beam;
  }

  // What lies behind a cell never seen is no likelihood at all, however near the end it is.
  static BeamModelParams of_the_known(BeamModelParams beam, double sigma_m) {
    beam.unknown_likelihood = 1e-6;
    return widened(beam, sigma_m);
  }

  BeamModel model_;
  BeamModel known_model_;
  double unknown_likelihood_;
  double cells_per_m_;
  int beams_used_;
  std::vector<Beam> beams_;
};

}  // namespace odoless
