#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/rng.hpp"
#include "core/math/elementary.hpp"
#include "tools/fault_campaign/faults.hpp"

namespace odoless::campaign {
namespace {

constexpr std::uint64_t kRangeStream = 43;
constexpr float kNothing_m = std::numeric_limits<float>::infinity();

template <class Change>
void for_each_active(const Fault& fault, ScanStream& stream, Change change) {
  for (SentScan& scan : stream.scans) {
    if (fault.active(scan.true_s)) {
      change(scan);
    }
  }
}

// The last scan before the fault, again and again.
void get_stuck(const Fault& fault, Rng& chance, ScanStream& stream) {
  const auto first =
      std::ranges::find_if(stream.scans, [&](const SentScan& scan) { return fault.active(scan.true_s); });
  if (first == stream.scans.begin() || first == stream.scans.end()) {
    return;
  }
  const std::vector<float> shown_m = (first - 1)->ranges_m;
  for_each_active(fault, stream, [&](SentScan& scan) {
    for (std::size_t i = 0; i < shown_m.size(); ++i) {
      const bool changes = chance.uniform() < fault.severity;
      const double noise_m = fault.severity * chance.normal();
      if (fault.kind == FaultKind::kStuckNoise) {
        scan.ranges_m[i] = shown_m[i] + static_cast<float>(noise_m);
      } else if (!changes) {
        scan.ranges_m[i] = shown_m[i];
      }
    }
  });
}

void corrupt(const Fault& fault, Rng& chance, ScanStream& stream) {
  constexpr double kLeast_m = 0.1;
  constexpr double kMost_m = 20.0;
  for_each_active(fault, stream, [&](SentScan& scan) {
    for (float& range_m : scan.ranges_m) {
      const bool is_wrong = chance.uniform() < fault.severity;
      const double wrong_m = chance.uniform(kLeast_m, kMost_m);
      range_m = is_wrong ? static_cast<float>(wrong_m) : range_m;
    }
  });
}

// Variant 0: nothing comes back; variant 1: dirt on the window does.
void lose_sector(const Fault& fault, Rng& chance, ScanStream& stream) {
  const auto beams = stream.scans.front().ranges_m.size();
  const auto size = static_cast<std::size_t>(fault.severity * static_cast<double>(beams));
  const auto first = static_cast<std::size_t>(chance.below(static_cast<std::uint32_t>(beams - size + 1)));
  const auto dirt_m = static_cast<float>(chance.uniform(0.06, 0.4));
  for_each_active(fault, stream, [&](SentScan& scan) {
    std::fill_n(scan.ranges_m.begin() + static_cast<std::ptrdiff_t>(first), size,
                fault.variant == 0 ? kNothing_m : dirt_m);
  });
}

/// Somebody who walks around the robot and with it, or past it.
struct Person {
  double distance_m;
  double bearing_rad;
  double turn_radps;
  double sway_m;
  double sway_radps;
};

Pillar seen_at(const Person& person, double true_s) {
  constexpr double kRadius_m = 0.25;
  const double distance_m = person.distance_m + person.sway_m * math::sin(person.sway_radps * true_s);
  const double bearing_rad = person.bearing_rad + person.turn_radps * true_s;
  return {{distance_m * math::cos(bearing_rad), distance_m * math::sin(bearing_rad)}, kRadius_m};
}

std::vector<Person> draw_people(const Fault& fault, Rng& chance) {
  std::vector<Person> people;
  for (int i = 0; i < static_cast<int>(fault.severity); ++i) {
    Person person{};
    person.distance_m = chance.uniform(1.0, 3.5);
    person.bearing_rad = chance.uniform(-std::numbers::pi, std::numbers::pi);
    person.turn_radps = chance.uniform(-0.3, 0.3);
    person.sway_m = chance.uniform(0.0, 0.5);
    person.sway_radps = chance.uniform(0.2, 1.5);
    people.push_back(person);
  }
  return people;
}

void crowd(const Fault& fault, Rng& chance, ScanStream& stream) {
  constexpr double kNoise_sd_m = 0.015;
  const std::vector<Person> people = draw_people(fault, chance);
  for_each_active(fault, stream, [&](SentScan& scan) {
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double angle_rad = stream.start_angle_rad + static_cast<double>(i) * stream.angle_step_rad;
      double nearest_m = std::numeric_limits<double>::infinity();
      for (const Person& person : people) {
        nearest_m = std::min(nearest_m, ray_to_pillar(seen_at(person, scan.true_s), {0.0, 0.0},
                                                      {math::cos(angle_rad), math::sin(angle_rad)}));
      }
      const double seen_m = nearest_m + kNoise_sd_m * chance.normal();
      scan.ranges_m[i] = std::min(scan.ranges_m[i], static_cast<float>(std::max(0.0, seen_m)));
    }
  });
}

void scale(const Fault& fault, ScanStream& stream) {
  for_each_active(fault, stream, [&](SentScan& scan) {
    for (float& range_m : scan.ranges_m) {
      range_m *= static_cast<float>(fault.severity);
    }
  });
}

void turn_over(const Fault& fault, ScanStream& stream) {
  for_each_active(fault, stream, [](SentScan& scan) { std::ranges::reverse(scan.ranges_m); });
}

}  // namespace

void apply_to_ranges(const Scenario& scenario, ScanStream& stream) {
  const Fault& fault = scenario.fault;
  Rng chance(scenario.seed, kRangeStream);
  switch (fault.kind) {
    case FaultKind::kStuck:
    case FaultKind::kStuckNoise:
      return get_stuck(fault, chance, stream);
    case FaultKind::kCorrupt:
      return corrupt(fault, chance, stream);
    case FaultKind::kDeadSector:
      return lose_sector(fault, chance, stream);
    case FaultKind::kCrowd:
      return crowd(fault, chance, stream);
    case FaultKind::kScaled:
      return scale(fault, stream);
    case FaultKind::kMirrored:
    case FaultKind::kUpsideDown:
      return turn_over(fault, stream);
    default:
      return;
  }
}

void apply_fault(const Scenario& scenario, ScanStream& stream) {
  apply_to_ranges(scenario, stream);
  apply_to_times(scenario, stream);
}

}  // namespace odoless::campaign
