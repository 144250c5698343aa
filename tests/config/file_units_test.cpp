#include "config/file_units.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace odoless {
namespace {

TEST(FileUnits, RenameAnglesAndTimesAlone) {
  EXPECT_EQ(key_in_file("search_yaw_rad"), "search_yaw_deg");
  EXPECT_EQ(key_in_file("yaw_rate_radps"), "yaw_rate_degps");
  EXPECT_EQ(key_in_file("budget_ns"), "budget_ms");
  EXPECT_EQ(key_in_file("cell_size_m"), "cell_size_m");
  EXPECT_EQ(key_in_file("gain"), "gain");
}

TEST(FileUnits, ConvertToRoundNumbers) {
  const FileUnit& angle = file_unit("yaw_rad");
  for (int degrees = -720; degrees <= 720; ++degrees) {
    const double inside_rad = from_file(angle, degrees);
    EXPECT_EQ(to_file(angle, inside_rad), degrees);
    EXPECT_DOUBLE_EQ(inside_rad, degrees / 180.0 * std::numbers::pi);
  }
  EXPECT_EQ(to_file(file_unit("period_ns"), 2'500'000.0), 2.5);
  EXPECT_EQ(to_file(file_unit("side_m"), 0.1), 0.1);
}

TEST(FileUnits, KnowTheSymbol) {
  EXPECT_EQ(unit_symbol("matcher.cell_size_m"), "m");
  EXPECT_EQ(unit_symbol("speed_mps"), "m/s");
  EXPECT_EQ(unit_symbol("area_m2"), "m²");
  EXPECT_EQ(unit_symbol("information_1_m2"), "1/m²");
  EXPECT_EQ(unit_symbol("noise_rad_per_m"), "1/m");
  EXPECT_EQ(unit_symbol("particles"), "");
}

}  // namespace
}  // namespace odoless
