#include "drivers/lrf/models.hpp"

#include <gtest/gtest.h>

#include <cctype>

#include "core/scan/scan_frame.hpp"

namespace odoless {
namespace {

TEST(LrfModels, AreFoundByTheirExactName) {
  for (const LrfModel& model : lrf_models()) {
    const LrfModel* const found = find_lrf_model(model.name);
    ASSERT_NE(found, nullptr) << model.name;
    EXPECT_EQ(found, &model) << "two models are called " << model.name;
  }
  EXPECT_EQ(find_lrf_model(""), nullptr);
  EXPECT_EQ(find_lrf_model("utm"), nullptr);
  EXPECT_EQ(find_lrf_model("UTM-30LX"), nullptr);
}

TEST(LrfModels, HaveNamesThatCanBeTyped) {
  for (const LrfModel& model : lrf_models()) {
    for (const char letter : model.name) {
      EXPECT_TRUE(std::islower(letter) != 0 || std::isdigit(letter) != 0 || letter == '-') << model.name;
    }
  }
}

TEST(LrfModels, DescribeLasersThatCanExist) {
  ASSERT_FALSE(lrf_models().empty());
  for (const LrfModel& model : lrf_models()) {
    SCOPED_TRACE(model.name);
    EXPECT_GE(model.field_of_view_deg, 70.0);
    EXPECT_LE(model.field_of_view_deg, 360.0);
    const double step_deg = model.field_of_view_deg / model.beams;
    EXPECT_GT(step_deg, 0.08);
    EXPECT_LT(step_deg, 1.5);
    EXPECT_GE(model.rate_hz, 1.0);
    EXPECT_LE(model.rate_hz, 100.0);
    EXPECT_GE(model.range_sd_m, 0.001);
    EXPECT_LT(model.range_sd_m, 0.01 * model.range_max_m);
  }
}

TEST(LrfModels, FitADefaultScanFrame) {
  for (const LrfModel& model : lrf_models()) {
    EXPECT_LE(model.beams, ScanParams{}.beams_max) << model.name;
  }
}

TEST(LrfModels, KnowTheLasersOfTheLogs) {
  const LrfModel* const lms200 = find_lrf_model("lms200");
  ASSERT_NE(lms200, nullptr);
  EXPECT_EQ(lms200->beams, 181);
  EXPECT_EQ(lms200->field_of_view_deg, 180.0);
  EXPECT_EQ(find_lrf_model("utm-30lx")->beams, 1081);
}

}  // namespace
}  // namespace odoless
