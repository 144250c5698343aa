#include "tools/fault_campaign/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/check.hpp"
#include "core/base/rng.hpp"
#include "core/math/elementary.hpp"
#include "tools/experiment/builtin_files.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::campaign {
namespace {

constexpr double kRun_s = 50.0;         // at most
constexpr double kAfterFault_s = 15.0;  // at least, for the way back
constexpr double kInstant_s = 0.0;

constexpr std::array<FaultSpec, 20> kSpecs{{
    {FaultKind::kNone, "none", {0.0, 0.0}, "", {0.0, 0.0}, true},
    {FaultKind::kSilence, "silence", {0.0, 0.0}, "", {1.0, 12.0}, true},
    {FaultKind::kGaps, "gaps", {0.4, 2.0}, "s of each gap", {5.0, 15.0}, true},
    {FaultKind::kDelay, "delay", {0.1, 2.0}, "s", {3.0, 12.0}, true},
    {FaultKind::kJitter, "jitter", {0.05, 1.0}, "s", {5.0, 15.0}, true},
    {FaultKind::kBursts, "bursts", {2.0, 10.0}, "scans at once", {5.0, 15.0}, true},
    {FaultKind::kWavering, "wavering", {0.05, 0.6}, "s", {0.0, 0.0}, false},
    {FaultKind::kJumping, "jumping", {1.0, 1.5e8}, "s", {3.0, 12.0}, false},
    {FaultKind::kStuck, "stuck", {0.004, 0.1}, "share of beams that change", {2.0, 10.0}, true},
    {FaultKind::kStuckNoise, "stuck-noise", {0.0005, 0.003}, "m of noise", {2.0, 10.0}, true},
    {FaultKind::kCorrupt, "corrupt", {0.05, 0.7}, "share of beams", {2.0, 12.0}, true},
    {FaultKind::kDeadSector, "dead-sector", {0.2, 0.8}, "share of beams", {3.0, 15.0}, true},
    {FaultKind::kCrowd, "crowd", {4.0, 16.0}, "people", {5.0, 20.0}, true},
    {FaultKind::kScaled, "scaled", {0.5, 2.0}, "times as far", {3.0, 12.0}, true},
    {FaultKind::kMirrored, "mirrored", {0.0, 0.0}, "", {0.0, 0.0}, true},
    {FaultKind::kUpsideDown, "upside-down", {0.0, 0.0}, "", {3.0, 12.0}, true},
    {FaultKind::kKidnapping, "kidnapping", {2.0, 6.0}, "m away", {0.0, 0.0}, true},
    {FaultKind::kSymmetric, "symmetric", {2.0, 6.0}, "m away", {2.0, 6.0}, true},
    {FaultKind::kCorridor, "corridor", {4.0, 10.0}, "m of range", {2.0, 6.0}, true},
    {FaultKind::kProcessStop, "process-stop", {0.0, 8.0}, "scans kept", {1.0, 8.0}, true},
}};

struct WorldUse {
  std::string_view name;
  double share;            // of the runs that may be anywhere
  bool small;              // enough for a laser that sees 5.6 m
  bool for_faults = true;  // its path is long enough
};

constexpr std::array<WorldUse, 7> kWorlds{{{"rooms", 0.32, true},
                                           {"office", 0.26, false},
                                           {"storey", 0.12, true},
                                           {"cave", 0.10, false},
                                           {"people", 0.10, true},
                                           {"symmetric", 0.06, true},
                                           {"spin", 0.04, true, false}}};

/// Worlds that only campaigns use.
constexpr std::string_view kRectangle = "room 0 0  9 6\nspeed 0.5\ngo 1 1  8 1  8 5  1 5  1 1  4 3\n";
constexpr std::string_view kLongCorridor = "room 0 0  60 2.4\nspeed 1\ngo 1.5 1.2  58.5 1.2\n";

/// Lasers of the market with fewer beams, which are enough and cost less.
struct LaserUse {
  std::string_view name;
  double share;
  bool far;  // sees more than a few metres
  SimulatedLrfParams params;
};

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
const std::array<LaserUse, 3> kLasers{{
    {"lms", 0.6, true, {}},
    {"utm",
     0.2,
     true,
     {.field_of_view_rad = 270.0 * kRadPerDeg, .beams = 271, .rate_hz = 10.0, .range_max_m = 30.0, .noise_sd_m = 0.01}},
    {"urg",
     0.2,
     false,
     {.field_of_view_rad = 240.0 * kRadPerDeg, .beams = 241, .rate_hz = 10.0, .range_max_m = 5.6, .noise_sd_m = 0.01}},
}};

const WorldUse& draw_world(Rng& chance, bool with_fault) {
  while (true) {
    double left = chance.uniform();
    for (const WorldUse& world : kWorlds) {
      left -= world.share;
      if (left < 0.0 && (world.for_faults || !with_fault)) {
        return world;
      }
    }
  }
}

const LaserUse& draw_laser(Rng& chance, bool small_world) {
  while (true) {
    double left = chance.uniform();
    for (const LaserUse& laser : kLasers) {
      left -= laser.share;
      if (left < 0.0) {
        if (laser.far || small_world) {
          return laser;
        }
        break;
      }
    }
  }
}

double draw(Rng& chance, const Bounds& bounds) { return chance.uniform(bounds.min, bounds.max); }

double draw_severity(Rng& chance, const FaultSpec& spec) {
  switch (spec.kind) {
    case FaultKind::kJumping: {  // any power of ten, forwards or back
      const double jump_s = math::exp(chance.uniform(math::log(spec.severity.min), math::log(spec.severity.max)));
      return chance.below(2) == 0 ? jump_s : -jump_s;
    }
    case FaultKind::kScaled: {
      constexpr double kLeast = 0.03;
      double factor = 1.0;
      while (std::abs(factor - 1.0) < kLeast) {
        factor = math::exp(chance.uniform(math::log(spec.severity.min), math::log(spec.severity.max)));
      }
      return factor;
    }
    case FaultKind::kBursts:
    case FaultKind::kCrowd:
    case FaultKind::kProcessStop:
      return std::floor(chance.uniform(spec.severity.min, spec.severity.max + 1.0));
    default:
      return draw(chance, spec.severity);
  }
}

void choose_place(Rng& chance, FaultKind kind, Scenario& scenario) {
  if (kind == FaultKind::kSymmetric) {
    scenario.world = chance.below(2) == 0 ? "symmetric" : "rectangle";
    scenario.speed_max_mps = 0.5;
    scenario.laser = draw_laser(chance, true).name;
  } else if (kind == FaultKind::kCorridor) {
    scenario.world = chance.below(2) == 0 ? "corridor" : "long-corridor";
    scenario.laser = chance.below(2) == 0 ? "lms" : "utm";
  } else {
    const WorldUse& world = draw_world(chance, kind != FaultKind::kNone);
    scenario.world = world.name;
    scenario.speed_max_mps = world.name == "symmetric" ? 0.5 : scenario.speed_max_mps;
    scenario.laser = draw_laser(chance, world.small).name;
  }
}

bool has_variants(FaultKind kind) {
  return kind == FaultKind::kDeadSector || kind == FaultKind::kSymmetric || kind == FaultKind::kCorridor ||
         kind == FaultKind::kProcessStop;
}

bool is_instant(const Fault& fault) {
  return fault.kind == FaultKind::kKidnapping || (fault.kind == FaultKind::kSymmetric && fault.variant == 1);
}

bool takes_the_whole_run(const Fault& fault) {
  return fault.kind == FaultKind::kWavering || fault.kind == FaultKind::kMirrored || fault.kind == FaultKind::kNone ||
         (fault.kind == FaultKind::kCorridor && fault.variant == 0);
}

void choose_times(Rng& chance, const FaultSpec& spec, Scenario& scenario) {
  Fault& fault = scenario.fault;
  const double start_s = chance.uniform(0.3, 0.55) * scenario.duration_s;
  const double lasts_s = draw(chance, spec.lasts_s);
  if (takes_the_whole_run(fault)) {
    fault.start_s = 0.0;
    fault.end_s = scenario.duration_s + 1.0;  // the last scan too
    return;
  }
  fault.start_s = start_s;
  fault.end_s = start_s + (is_instant(fault) ? kInstant_s : lasts_s);
  fault.end_s = std::min(fault.end_s, std::max(start_s + spec.lasts_s.min, scenario.duration_s - kAfterFault_s));
}

}  // namespace

std::span<const FaultSpec> fault_specs() { return kSpecs; }

const FaultSpec& spec_of(FaultKind kind) {
  const FaultSpec& spec = kSpecs.at(static_cast<std::size_t>(kind));
  ODOLESS_CHECK(spec.kind == kind);
  return spec;
}

const FaultSpec* find_fault(std::string_view name) {
  const auto* const found = std::ranges::find(kSpecs, name, &FaultSpec::name);
  return found == kSpecs.end() ? nullptr : found;
}

Scenario draw_scenario(std::uint64_t campaign_seed, int index) {
  constexpr int kFaultFreeEvery = 5;
  const int before = index / kFaultFreeEvery;  // fault-free ones
  const bool fault_free = index % kFaultFreeEvery == kFaultFreeEvery - 1;
  const int faults = static_cast<int>(kSpecs.size()) - 1;
  const int kind = fault_free ? 0 : 1 + (index - before) % faults;
  return draw_scenario(campaign_seed, index, static_cast<FaultKind>(kind));
}

Scenario draw_scenario(std::uint64_t campaign_seed, int index, FaultKind kind) {
  constexpr std::uint64_t kScenarioStream = 40;
  Scenario scenario{.index = index};
  scenario.seed = campaign_seed * 1'000'003U + static_cast<std::uint64_t>(index);
  Rng chance(scenario.seed, kScenarioStream);
  const FaultSpec& spec = spec_of(kind);
  scenario.fault.kind = kind;
  scenario.fault.variant = static_cast<int>(chance.below(2));
  choose_place(chance, kind, scenario);
  scenario.fault.severity = draw_severity(chance, spec);
  const double path_s = Path(load_world(scenario).waypoints).duration_s();
  scenario.path_start_s = chance.uniform(0.0, std::max(0.0, path_s - kRun_s));
  scenario.duration_s = std::min(kRun_s, path_s - scenario.path_start_s);
  choose_times(chance, spec, scenario);
  return scenario;
}

std::string describe(const Scenario& scenario) {
  const Fault& fault = scenario.fault;
  const FaultSpec& spec = spec_of(fault.kind);
  const bool is_silence = fault.kind == FaultKind::kSymmetric && fault.variant == 0;
  const std::string severity =
      spec.severity.max > 0.0 && !is_silence ? fmt::format(", {:.4g} {}", fault.severity, spec.severity_unit) : "";
  const std::string variant = has_variants(fault.kind) ? fmt::format(" variant {},", fault.variant) : "";
  return fmt::format("{:5} {:12}{} {:4.1f} to {:4.1f} s of {:4.1f} s, world {} from {:.1f} s, laser {}{}",
                     scenario.index, spec.name, variant, fault.start_s, fault.end_s, scenario.duration_s,
                     scenario.world, scenario.path_start_s, scenario.laser, severity);
}

World load_world(const Scenario& scenario) {
  const auto parse = [&](std::string_view text) {
    return slowed(parse_world(text, scenario.world), scenario.speed_max_mps);
  };
  if (scenario.world == "rectangle") {
    return parse(kRectangle);
  }
  return parse(scenario.world == "long-corridor" ? kLongCorridor : builtin_file(scenario.world + ".world"));
}

SimulatedLrfParams laser_of(const Scenario& scenario) {
  const auto found = std::ranges::find(kLasers, std::string_view(scenario.laser), &LaserUse::name);
  ODOLESS_CHECK(found != kLasers.end());
  SimulatedLrfParams params = found->params;
  if (scenario.fault.kind == FaultKind::kCorridor) {
    params.range_max_m = scenario.fault.severity;
  }
  return params;
}

}  // namespace odoless::campaign
