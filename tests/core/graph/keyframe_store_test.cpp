#include "core/graph/keyframe_store.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

ScanFrame frame_of(const std::vector<float>& ranges_m, std::int64_t beam_period_ns = 0) {
  ScanFrame frame(ScanParams{});
  const RawScan raw{.stamp_ns = 42,
                    .start_angle_rad = -1.5,
                    .angle_step_rad = 3.0 / static_cast<double>(ranges_m.size()),
                    .beam_period_ns = beam_period_ns,
                    .ranges_m = ranges_m};
  EXPECT_EQ(frame.assign(raw), Errc::kOk);
  return frame;
}

int add(KeyframeStore& store, const ScanFrame& scan) {
  Keyframe keyframe;
  std::vector<BeamCode> codes(static_cast<std::size_t>(keyframe_beams(scan.size(), 541)));
  encode(scan, 541, keyframe, codes);
  return store.add(keyframe, codes);
}

TEST(KeyframeStore, GivesBackEachBeamWithin2Millimetres) {
  Rng rng(1);
  std::vector<float> ranges_m(361);
  for (float& range_m : ranges_m) {
    range_m = static_cast<float>(rng.uniform(0.06, 29.0));
  }
  ranges_m[10] = kInfinity;
  ranges_m[11] = std::numeric_limits<float>::quiet_NaN();
  const ScanFrame scan = frame_of(ranges_m);
  KeyframeStore store(4, 541);
  const int index = add(store, scan);
  ScanFrame loaded(ScanParams{});
  store.load(index, 1, loaded);
  ASSERT_EQ(loaded.size(), scan.size());
  EXPECT_EQ(loaded.stamp_ns(), 42);
  store.place(index, {1.0, 2.0, 0.5});
  EXPECT_EQ(store.submap_T_scan(index).x_m, 1.0);
  for (int i = 0; i < scan.size(); ++i) {
    ASSERT_EQ(loaded.state(i), scan.state(i)) << "beam " << i;
    EXPECT_NEAR(loaded.range_m(i), scan.range_m(i), 0.0021) << "beam " << i;
    EXPECT_NEAR(loaded.angle_rad(i), scan.angle_rad(i), 1e-12);
  }
}

TEST(KeyframeStore, ForgetsKeyframesAndHasRoomForOthers) {
  KeyframeStore store(4, 541);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(add(store, frame_of(std::vector<float>(static_cast<std::size_t>(100 + i), 1.0F + static_cast<float>(i)))),
              i);
  }
  store.erase({false, true, true, false});
  ASSERT_EQ(store.size(), 2);
  EXPECT_EQ(store[1].beams, 103);
  EXPECT_NEAR(range_of(store.codes(1)[102]), 4.0F, 0.003F);
  EXPECT_EQ(add(store, frame_of(std::vector<float>(120, 7.0F))), 2);
  EXPECT_NEAR(range_of(store.codes(2)[0]), 7.0F, 0.003F);
  EXPECT_NEAR(range_of(store.codes(0)[0]), 1.0F, 0.003F);
  EXPECT_EQ(store.serial(0), 0);
  EXPECT_EQ(store.serial(1), 3) << "the same as ever";
  EXPECT_EQ(store.serial(2), 4);
  EXPECT_EQ(store.serial(3), 5) << "of the next one";
}

TEST(KeyframeStore, ThinsScansWithMoreBeamsThanItKeeps) {
  const ScanFrame scan = frame_of(std::vector<float>(1081, 3.0F));
  KeyframeStore store(4, 541);
  const int index = add(store, scan);
  EXPECT_EQ(store[index].beams, 541);
  ScanFrame loaded(ScanParams{});
  store.load(index, 3, loaded);
  EXPECT_EQ(loaded.size(), 181);
  EXPECT_NEAR(loaded.angle_rad(180), scan.angle_rad(1080), 1e-9);
}

// A scan that was deskewed has beams at uneven angles.
TEST(KeyframeStore, PutsDeskewedBeamsWhereTheySee) {
  ScanFrame scan = frame_of(std::vector<float>(361, 2.0F), 200'000);
  scan.deskew({2.0, 0.5, 1.0});
  KeyframeStore store(4, 541);
  ScanFrame loaded(ScanParams{});
  store.load(add(store, scan), 1, loaded);
  int found = 0;
  for (int i = 0; i < scan.size(); ++i) {
    for (int k = 0; k < loaded.size(); ++k) {
      const double off_m = std::hypot(loaded.point(k).x_m - scan.point(i).x_m, loaded.point(k).y_m - scan.point(i).y_m);
      if (loaded.is_return(k) && off_m < 0.5 * 2.2 * scan.angle_step_rad() + 0.01) {
        ++found;
        break;
      }
    }
  }
  EXPECT_GT(found, 350);
}

TEST(KeyframeStore, SaysWhenItIsFullAndHowFarItSees) {
  KeyframeStore store(2, 541);
  const int index = add(store, frame_of({1.0F, 7.0F, kInfinity, 2.0F, 1.0F, 1.0F, 1.0F, 1.0F}));
  EXPECT_NEAR(store.farthest_m(index), 7.0, 0.002);
  EXPECT_FALSE(store.full());
  EXPECT_NEAR(store.farthest_m(add(store, frame_of(std::vector<float>(8, kInfinity)))), 0.0, 1e-12);
  EXPECT_TRUE(store.full());
}

}  // namespace
}  // namespace odoless
