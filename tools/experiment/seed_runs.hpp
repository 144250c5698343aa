#pragma once

#include <string>

#include "tools/experiment/run.hpp"

namespace odoless {

/// The multi-room building of Figure 5.8 and its 366 scans.
[[nodiscard]] Scene rooms_scene(double noise_sd_m);

/// Pairs of that building matched by the dissertation's setting with another population and other generations.
[[nodiscard]] Run seed_pairs(int population, int generations, double noise_sd_m);

/// The same with what is built in.
[[nodiscard]] Run default_pairs(double noise_sd_m);

/// The matcher of the dissertation: N members, G generations.
[[nodiscard]] MatcherParams seed_matcher(int population, int generations);

constexpr int kSeedPopulation = 100;
constexpr int kSeedGenerations = 50;
constexpr double kSeedNoiseM = 0.015;

}  // namespace odoless
