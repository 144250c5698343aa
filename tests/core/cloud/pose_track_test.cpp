#include "core/cloud/pose_track.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;
constexpr double kTurn_radps = 0.7;

/// Stands until `from_s`, then turns on the spot.
Pose2 pose_at(double time_s, double from_s) { return {1.0, 2.0, kTurn_radps * std::max(0.0, time_s - from_s)}; }

/// Three poses 25 ms apart per level pass, a pass every 400 ms: as a nodding laser gives them.
PoseTrack track_of(double turns_from_s, double yaw_doubt_max_rad) {
  PoseTrack track(1000, 1000 * kMs, yaw_doubt_max_rad);
  for (int pass = 0; pass < 10; ++pass) {
    for (int scan = 0; scan < 3; ++scan) {
      const std::int64_t stamp_ns = (400 * pass + 25 * scan) * kMs;
      EXPECT_TRUE(track.add(stamp_ns, pose_at(static_cast<double>(stamp_ns) * 1e-9, turns_from_s)));
    }
  }
  return track;
}

TEST(PoseTrack, KnowsEvenMotionExactly) {
  for (const double turns_from_s : {-1.0, 100.0}) {  // always, or never
    const PoseTrack track = track_of(turns_from_s, 0.01);
    for (std::int64_t stamp_ns = 0; stamp_ns < 3600 * kMs; stamp_ns += 7 * kMs) {
      const Result<Pose2> pose = track.at(stamp_ns);
      ASSERT_TRUE(pose.ok()) << stamp_ns;
      const Pose2 truth = pose_at(static_cast<double>(stamp_ns) * 1e-9, turns_from_s);
      EXPECT_NEAR(wrap_angle(pose.value().yaw_rad - truth.yaw_rad), 0.0, 1e-9);
      EXPECT_NEAR(pose.value().x_m, 1.0, 1e-12);
    }
  }
}

// Wherever the turn begins: what is given is within the bound, and only what is near the beginning is left out.
TEST(PoseTrack, LeavesOutWhereTheYawMayBeOff) {
  constexpr double kBoundRad = 0.01;
  for (double turns_from_s = 0.8; turns_from_s < 1.6; turns_from_s += 0.03) {
    const PoseTrack track = track_of(turns_from_s, kBoundRad);
    int known = 0;
    int asked = 0;
    for (std::int64_t stamp_ns = 0; stamp_ns < 3600 * kMs; stamp_ns += 5 * kMs, ++asked) {
      const Result<Pose2> pose = track.at(stamp_ns);
      const double truth_rad = pose_at(static_cast<double>(stamp_ns) * 1e-9, turns_from_s).yaw_rad;
      known += pose.ok() ? 1 : 0;
      EXPECT_TRUE(!pose.ok() || std::abs(wrap_angle(pose.value().yaw_rad - truth_rad)) <= 2.0 * kBoundRad)
          << turns_from_s << " " << stamp_ns;
      EXPECT_TRUE(pose.ok() || pose.error() == Errc::kGap);
    }
    EXPECT_GE(known, asked * 2 / 3) << turns_from_s;
  }
}

TEST(PoseTrack, WaitsForThePoseAfterTheNext) {
  PoseTrack track(10, 1000 * kMs, 0.01);
  EXPECT_EQ(track.at(0).error(), Errc::kNotYet);
  track.add(0, {});
  track.add(400 * kMs, {1.0, 0.0, 0.0});
  EXPECT_TRUE(track.at(400 * kMs).ok()) << "at a pose nothing is in doubt";
  EXPECT_EQ(track.at(200 * kMs).error(), Errc::kNotYet);
  track.add(425 * kMs, {1.0, 0.0, 0.0});
  ASSERT_TRUE(track.at(200 * kMs).ok());
  EXPECT_DOUBLE_EQ(track.at(200 * kMs).value().x_m, 0.5);
  EXPECT_EQ(track.at(-1).error(), Errc::kTooOld);
  EXPECT_FALSE(track.add(425 * kMs, {}));
}

}  // namespace
}  // namespace odoless
