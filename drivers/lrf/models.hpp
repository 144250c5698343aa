#pragma once

#include <span>
#include <string_view>

namespace odoless {

/// What a laser range finder's data sheet says.
struct LrfModel {
  std::string_view name;
  double field_of_view_deg;
  int beams;
  double rate_hz;
  double range_max_m;
  double range_sd_m;  ///< standard deviation of one range
};

/// The lasers that the project knows, each usable as a preset of the simulator.
[[nodiscard]] std::span<const LrfModel> lrf_models();

/// The model of that name, or null.
[[nodiscard]] const LrfModel* find_lrf_model(std::string_view name);

}  // namespace odoless
