#include "core/scan/scan_frame.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace odoless {
namespace {

RawScan raw(std::span<const float> ranges_m) {
  return {.stamp_ns = 7, .start_angle_rad = -1.0, .angle_step_rad = 0.25, .no_return_m = 8.1F, .ranges_m = ranges_m};
}

TEST(ScanFrame, ClassifiesEveryKindOfBeam) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::array<float, 9> ranges_m{1.0F, 8.1F, kInf, kNan, 0.0F, -1.0F, 0.01F, 5.0F, 6.5F};
  ScanFrame frame(ScanParams{.range_min_m = 0.1, .range_max_m = 6.0});
  ASSERT_EQ(frame.assign(raw(ranges_m)), Errc::kOk);
  using enum BeamState;
  const std::array<BeamState, 9> expected{kReturn,  kNoReturn, kNoReturn, kInvalid, kInvalid,
                                          kInvalid, kInvalid,  kReturn,   kNoReturn};
  for (int i = 0; i < frame.size(); ++i) {
    EXPECT_EQ(frame.state(i), expected[static_cast<std::size_t>(i)]) << "beam " << i;
  }
  EXPECT_EQ(frame.returns(), 2);
  EXPECT_EQ(frame.stamp_ns(), 7);
}

TEST(ScanFrame, BearsItsStampAsTimeUntilItIsToldABetterOne) {
  const std::array<float, 3> ranges_m{2.0F, 3.0F, 4.0F};
  ScanFrame frame(ScanParams{});
  ASSERT_EQ(frame.assign(raw(ranges_m)), Errc::kOk);
  EXPECT_EQ(frame.time_ns(), 7);
  EXPECT_EQ(frame.time_sd_s(), 0.0);
  frame.set_time({.time_ns = 9, .sd_s = 0.5});
  EXPECT_EQ(frame.stamp_ns(), 7);
  EXPECT_EQ(frame.time_ns(), 9);
  EXPECT_EQ(frame.time_sd_s(), 0.5);
  ASSERT_EQ(frame.assign(raw(ranges_m)), Errc::kOk);
  EXPECT_EQ(frame.time_ns(), 7) << "the next scan's time is its own";
}

TEST(ScanFrame, PlacesPointsByStartAngleAndStep) {
  const std::array<float, 3> ranges_m{2.0F, 3.0F, 4.0F};
  ScanFrame frame(ScanParams{});
  ASSERT_EQ(frame.assign(raw(ranges_m)), Errc::kOk);
  EXPECT_NEAR(frame.point(2).x_m, 4.0 * std::cos(-0.5), 1e-12);
  EXPECT_NEAR(frame.point(2).y_m, 4.0 * std::sin(-0.5), 1e-12);
}

TEST(ScanFrame, FollowsAGeometryThatChangesFromScanToScan) {
  const std::array<float, 3> ranges_m{2.0F, 2.0F, 2.0F};
  ScanFrame frame(ScanParams{});
  ASSERT_EQ(frame.assign(raw(std::span(ranges_m).first(1))), Errc::kOk);
  ASSERT_EQ(frame.assign({.start_angle_rad = 0.5, .angle_step_rad = -0.5, .ranges_m = ranges_m}), Errc::kOk);
  EXPECT_NEAR(frame.point(1).x_m, 2.0, 1e-12);
  EXPECT_NEAR(frame.point(2).y_m, 2.0 * std::sin(-0.5), 1e-12);
}

TEST(ScanFrame, RefusesWhatItCannotHoldAndStaysAsItWas) {
  const std::array<float, 9> ranges_m{1, 1, 1, 1, 1, 1, 1, 1, 1};
  ScanFrame frame(ScanParams{.beams_max = 8});
  ASSERT_EQ(frame.assign(raw(std::span(ranges_m).first(3))), Errc::kOk);
  EXPECT_EQ(frame.assign(raw(ranges_m)), Errc::kTooManyBeams);
  RawScan bad = raw(std::span(ranges_m).first(3));
  bad.angle_step_rad = 0.0;
  EXPECT_EQ(frame.assign(bad), Errc::kBadGeometry);
  bad.angle_step_rad = std::nan("");
  EXPECT_EQ(frame.assign(bad), Errc::kBadGeometry);
  EXPECT_EQ(frame.size(), 3);
}

}  // namespace
}  // namespace odoless
