#include "tools/experiment/seed_runs.hpp"

#include <fmt/format.h>

#include <cmath>

namespace odoless {
namespace {

std::string in_mm(double length_m) { return fmt::format("{}mm", std::lround(length_m * 1e3)); }

}  // namespace

Scene rooms_scene(double noise_sd_m) { return {.world = "rooms.world", .lrf = {.noise_sd_m = noise_sd_m}}; }

MatcherParams seed_matcher(int population, int generations) {
  MatcherParams params = seed_matcher_params();
  params.search.de.population = population;
  params.search.start_points = population;
  params.search.fine_evaluations = population * generations;
  return params;
}

Run seed_pairs(int population, int generations, double noise_sd_m) {
  Run run;
  run.name = fmt::format("rooms-{}-seed-n{}-g{}", in_mm(noise_sd_m), population, generations);
  run.scene = rooms_scene(noise_sd_m);
  run.params.matcher = seed_matcher(population, generations);
  return run;
}

Run default_pairs(double noise_sd_m) {
  Run run;
  run.name = fmt::format("rooms-{}-default", in_mm(noise_sd_m));
  run.scene = rooms_scene(noise_sd_m);
  return run;
}

}  // namespace odoless
