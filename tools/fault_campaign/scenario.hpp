#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sim/simulated_lrf.hpp"
#include "tools/sim/world.hpp"

namespace odoless::campaign {

/// What goes wrong; README.md says exactly what each is.
enum class FaultKind : std::uint8_t {
  kNone,
  kSilence,
  kGaps,
  kDelay,
  kJitter,
  kBursts,
  kWavering,
  kJumping,
  kStuck,
  kStuckNoise,
  kCorrupt,
  kDeadSector,
  kCrowd,
  kScaled,
  kMirrored,
  kUpsideDown,
  kKidnapping,
  kSymmetric,
  kCorridor,
  kProcessStop,
};

/// One fault of a run. Times are true ones, since the run's first scan.
struct Fault {
  FaultKind kind = FaultKind::kNone;
  double start_s = 0.0;
  double end_s = 0.0;
  double severity = 0.0;  ///< in the unit that the kind has
  int variant = 0;        ///< 0 or 1, where the kind has two

  [[nodiscard]] bool active(double true_s) const { return true_s >= start_s && true_s < end_s; }
};

/// One run: all that it depends on besides the program.
struct Scenario {
  int index = 0;
  std::string world{};         ///< one of world_names()
  std::string laser{};         ///< one of laser_names()
  double path_start_s = 0.0;   ///< where on the world's path the run begins
  double speed_max_mps = 5.0;  ///< the world's path is driven no faster
  double duration_s = 0.0;
  Fault fault{};
  std::uint64_t seed = 1;  ///< of noise, fault and method
};

/// Bounds of something that is drawn.
struct Bounds {
  double min = 0.0;
  double max = 0.0;
};

/// How a kind of fault is drawn, and how it is played.
struct FaultSpec {
  FaultKind kind = FaultKind::kNone;
  std::string_view name{};
  Bounds severity{};
  std::string_view severity_unit{};
  Bounds lasts_s{};   ///< 0 and 0: the whole run, or an instant
  bool live = false;  ///< late scans are refused, as of a device
};

[[nodiscard]] std::span<const FaultSpec> fault_specs();
[[nodiscard]] const FaultSpec& spec_of(FaultKind kind);
/// The spec of that name, or null.
[[nodiscard]] const FaultSpec* find_fault(std::string_view name);

/// The run of that index. The same random seed and index give the same run, whatever else is run.
[[nodiscard]] Scenario draw_scenario(std::uint64_t campaign_seed, int index);
/// The same, of that kind of fault.
[[nodiscard]] Scenario draw_scenario(std::uint64_t campaign_seed, int index, FaultKind kind);

/// One line: index, kind, severity, times, world, laser.
[[nodiscard]] std::string describe(const Scenario& scenario);

[[nodiscard]] World load_world(const Scenario& scenario);
[[nodiscard]] SimulatedLrfParams laser_of(const Scenario& scenario);

}  // namespace odoless::campaign
