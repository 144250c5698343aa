#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/parameters.hpp"

namespace odoless {

enum class ExampleColour { kRed, kGreen, kBlue };
inline constexpr std::array<const char*, 3> kExampleColourNames{"red", "green", "blue"};

struct ExampleInnerParams {
  double yaw_max_rad = 20.0 * std::numbers::pi / 180.0;
  double gain = 0.5;
  std::int64_t period_ns = 100'000'000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("yaw_max_rad", self.yaw_max_rad, Range{0.0, std::numbers::pi}, "Widest turn searched.");
    visit.value("gain", self.gain, Range{0.0, 1.0}, "Share of a | that is kept.");
    visit.value("period_ns", self.period_ns, Range<std::int64_t>{1, 10'000'000'000}, "Time between scans.");
  }
};

/// One parameter of every kind, groups in groups, and values behind a group.
struct ExampleParams {
  double cell_size_m = 1.0;
  int particles = 100;
  ExampleInnerParams inner;
  std::int64_t seed = 1;
  bool refine = true;
  ExampleColour colour = ExampleColour::kGreen;
  std::string device = "/dev/laser";
  std::vector<AngleSector> blind{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("cell_size_m", self.cell_size_m, Range{0.1, 20.0}, "Side of an NDT cell.");
    visit.value("particles", self.particles, Range{1, 1000}, "Number of particles.");
    visit.group("inner", self.inner, "The inner group.");
    visit.value("seed", self.seed, Range<std::int64_t>{0, INT64_MAX}, "Where chance starts.");
    visit.flag("refine", self.refine, "Whether a Newton step ends the search.");
    visit.choice("colour", self.colour, kExampleColourNames, "NDT's colour.");
    visit.text("device", self.device, "Path of the laser.");
    visit.sectors("blind", self.blind, "Where nothing is seen.");
  }
};

struct ExampleOuterParams {
  ExampleParams matcher;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("matcher", self.matcher, "The matcher.");
  }
};

}  // namespace odoless
