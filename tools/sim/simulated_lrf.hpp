#pragma once

#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/base/rng.hpp"
#include "drivers/lrf/models.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world.hpp"

namespace odoless {

/// The simulated laser range finder; the defaults are the preset "lms200".
struct SimulatedLrfParams {
  double field_of_view_rad = std::numbers::pi;
  int beams = 181;
  double rate_hz = 5.0;
  double range_max_m = 80.0;
  double noise_sd_m = 0.015;
  double no_return_share = 0.0;
  bool distortion = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value(
        "field_of_view_rad", self.field_of_view_rad, Range{std::numbers::pi / 180.0, 2.0 * std::numbers::pi},
        "Angle between the first beam and the last; a full circle has its last beam one step before the first.");
    visit.value("beams", self.beams, Range{2, 16384}, "Beams of one scan.");
    visit.value("rate_hz", self.rate_hz, Range{0.01, 1000.0}, "Scans per second.");
    visit.value("range_max_m", self.range_max_m, Range{0.1, 1000.0}, "Farther surfaces give no return.");
    visit.value("noise_sd_m", self.noise_sd_m, Range{0.0, 10.0}, "Standard deviation of the Gaussian range noise.");
    visit.value("no_return_share", self.no_return_share, Range{0.0, 1.0}, "Share of beams that drop out at random.");
    visit.flag(
        "distortion", self.distortion,
        "Whether each beam is cast at its own time, the mirror turning once per scan, and the scan is bent by motion.");
  }
};

/// What the data sheet says, as parameters of the simulation.
[[nodiscard]] SimulatedLrfParams simulated_lrf_params(const LrfModel& model);

/// A laser in the robot's middle that looks forward along its x; scan frame = robot frame.
///
/// The same world, path, parameters and seed give the same ranges. Noise and lost returns come from separate streams
/// of chance: changing one leaves the other as it was.
class SimulatedLrf {
 public:
  SimulatedLrf(const SimulatedLrfParams& params, std::uint64_t seed);

  [[nodiscard]] double start_angle_rad() const { return -params_.field_of_view_rad / 2.0; }
  [[nodiscard]] double angle_step_rad() const { return angle_step_rad_; }
  [[nodiscard]] const SimulatedLrfParams& params() const { return params_; }

  /// The ranges in metres, from the first beam (right) to the last (left), infinity for no return; valid until the
  /// next call. The first beam leaves at `time_s`.
  [[nodiscard]] std::span<const double> sweep(const World& world, const Path& path, double time_s);

  /// Distance to the first surface along a beam that leaves at a time, at an angle in the laser's frame.
  using TrueRange = std::function<double(double time_s, double angle_rad)>;
  /// The same of anything that a laser may look at.
  [[nodiscard]] std::span<const double> sweep(const TrueRange& true_range_m, double time_s);

  /// From beam to beam; 0 without distortion.
  [[nodiscard]] double beam_period_s() const;

 private:
  [[nodiscard]] double measured_m(double true_m);

  SimulatedLrfParams params_;
  double angle_step_rad_;
  Rng noise_;
  Rng loss_;
  std::vector<double> ranges_m_;
};

}  // namespace odoless
