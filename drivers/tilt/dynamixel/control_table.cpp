#include "drivers/tilt/dynamixel/control_table.hpp"

#include <algorithm>
#include <array>

namespace odoless::dynamixel {
namespace {

struct Model {
  std::uint32_t number;
  ControlTable table;
};

constexpr double kPh54 = 1'003'846.0;
constexpr double kPh42 = 607'500.0;
constexpr double kPm54 = 502'834.0;
constexpr double kPm42 = 526'374.0;
constexpr std::array<Model, 12> kModelsOfP{{
    {2000, table_of_p(kPh42)},   // PH42-020-S300
    {2010, table_of_p(kPh54)},   // PH54-100-S500
    {2020, table_of_p(kPh54)},   // PH54-200-S500
    {2100, table_of_p(kPm42)},   // PM42-010-S260
    {2110, table_of_p(kPm54)},   // PM54-040-S250
    {2120, table_of_p(kPm54)},   // PM54-060-S250
    {43289, table_of_p(kPm42)},  // the same with PRO's housing: M42-10-S260-RA
    {46097, table_of_p(kPm54)},  // M54-40-S250-RA
    {46353, table_of_p(kPm54)},  // M54-60-S250-RA
    {51201, table_of_p(kPh42)},  // H42-20-S300-RA
    {53769, table_of_p(kPh54)},  // H54-100-S500-RA
    {54025, table_of_p(kPh54)},  // H54-200-S500-RA
}};

constexpr std::uint32_t kXl320 = 350;
constexpr std::uint32_t kFirstOfPro = 35'000;

}  // namespace

std::optional<ControlTable> control_table(std::uint32_t model_number) {
  const auto* const found = std::find_if(kModelsOfP.begin(), kModelsOfP.end(),
                                         [&](const Model& model) { return model.number == model_number; });
  if (found != kModelsOfP.end()) {
    return found->table;
  }
  const bool is_another = model_number == kXl320 || model_number >= kFirstOfPro;
  return is_another ? std::nullopt : std::optional(kTableOfX);
}

}  // namespace odoless::dynamixel
