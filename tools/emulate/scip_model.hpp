#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_scans.hpp"

namespace odoless {

/// A laser that speaks SCIP 2.0 or what came of it, as its sheet and its answers to VV, PP and II have it.
struct ScipModel {
  std::string_view name;     ///< as in drivers/lrf/models.hpp
  std::string_view product;  ///< MODL and PROD
  std::string_view protocol = "SCIP 2.0";
  int range_min_mm;
  int range_max_mm;  ///< what PP says
  int range_far_mm;  ///< what it really sees
  int steps_per_turn;
  int first_step;
  int last_step;
  int front_step;
  int turns_per_minute;
  bool boots_in_scip1;  ///< answers E to everything until it hears SCIP2.0
  int far_code;         ///< what it sends where nothing was hit
  int near_code;        ///< what it sends where it can say nothing
  double range_sd_m;    ///< standard deviation of one range
  bool is_newer;        ///< tells its time, and who it is, in whichever mode it is, and can be rebooted (RB)
  bool has_echoes;      ///< tells several echoes of one beam (ND, NE, HD, HE)

  [[nodiscard]] int beams() const { return last_step - first_step + 1; }
  [[nodiscard]] std::int64_t turn_ns() const { return 60'000'000'000 / turns_per_minute; }
  /// Time that the mirror takes from step 0.
  [[nodiscard]] std::int64_t time_to_step_ns(int step) const { return turn_ns() * step / steps_per_turn; }
  /// Of a beam, counted from `first_step`; 0 is the front, positive to the left.
  [[nodiscard]] double angle_rad(int beam) const;
  [[nodiscard]] std::vector<EmulatedBeam> beam_list() const;
};

[[nodiscard]] std::span<const ScipModel> scip_models();

/// The model of that name, or null.
[[nodiscard]] const ScipModel* find_scip_model(std::string_view name);

}  // namespace odoless
