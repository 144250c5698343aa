#include "tools/emulate/scip_model.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace odoless {
namespace {

constexpr ScipModel kUtm{.name = "utm-30lx",
                         .product = "UTM-30LX",
                         .range_min_mm = 23,
                         .range_max_mm = 60000,
                         .range_far_mm = 30000,
                         .steps_per_turn = 1440,
                         .first_step = 0,
                         .last_step = 1080,
                         .front_step = 540,
                         .turns_per_minute = 2400,
                         .boots_in_scip1 = false,
                         .far_code = 1,
                         .near_code = 2,
                         .range_sd_m = 0.010,
                         .is_newer = true,
                         .has_echoes = false};

constexpr ScipModel several_echoes() {
  ScipModel model = kUtm;
  model.name = "utm-30lx-ew";
  model.product = "UTM-30LX-EW";
  model.has_echoes = true;
  return model;
}

constexpr ScipModel ust() {
  ScipModel model = kUtm;
  model.name = "ust-10lx";
  model.product = "UST-10LX";
  model.protocol = "SCIP 2.2";
  model.range_min_mm = 20;
  model.range_max_mm = 30000;
  model.range_far_mm = 10000;
  model.far_code = 65533;
  model.near_code = 0;
  model.range_sd_m = 0.015;
  return model;
}

constexpr ScipModel kUrg{.name = "urg-04lx",
                         .product = "URG-04LX",
                         .range_min_mm = 20,
                         .range_max_mm = 5600,
                         .range_far_mm = 5600,
                         .steps_per_turn = 1024,
                         .first_step = 44,
                         .last_step = 725,
                         .front_step = 384,
                         .turns_per_minute = 600,
                         .boots_in_scip1 = true,
                         .far_code = 0,
                         .near_code = 7,
                         .range_sd_m = 0.010,
                         .is_newer = false,
                         .has_echoes = false};

constexpr std::array kModels{kUtm, several_echoes(), kUrg, ust()};

}  // namespace

double ScipModel::angle_rad(int beam) const {
  return (first_step + beam - front_step) * 2.0 * std::numbers::pi / steps_per_turn;
}

std::vector<EmulatedBeam> ScipModel::beam_list() const {
  std::vector<EmulatedBeam> list;
  for (int beam = 0; beam < beams(); ++beam) {
    list.push_back({angle_rad(beam), time_to_step_ns(first_step + beam)});
  }
  return list;
}

std::span<const ScipModel> scip_models() { return kModels; }

const ScipModel* find_scip_model(std::string_view name) {
  const auto* const found =
      std::find_if(kModels.begin(), kModels.end(), [&](const ScipModel& m) { return m.name == name; });
  return found == kModels.end() ? nullptr : found;
}

}  // namespace odoless
