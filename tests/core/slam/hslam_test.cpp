#include "core/slam/hslam.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/core/slam/same_pose.hpp"
#include "tests/support/plain_segments.hpp"
#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

constexpr ScanParams kScan{.beams_max = 120, .range_max_m = 20.0};

LslamParams low_params() {
  LslamParams params;
  params.particles = 10;
  params.grid = {.resolution_m = 0.1, .width_m = 8.0, .height_m = 8.0, .tiles_max = 8000};
  return params;
}

HslamParams high_params() {
  HslamParams params;
  params.particles = 12;
  params.segment_updates = 5;
  params.scans_weighed = 3;
  params.beams_used = 20;
  params.refine_steps = 2;
  params.grid = low_params().grid;
  return params;
}

/// A low-level run through a room, cut into segments.
class LowRun {
 public:
  explicit LowRun(int segment_updates = 5) : segment_({}, segment_updates, low_params().particles, kScan) {}

  const RunSegment& next_segment() {
    segment_.clear();
    while (!segment_.full()) {
      room_.step();
      static_cast<void>(low_.update(room_.motion(), room_.scan()));
      segment_.add(room_.motion(), room_.scan());
    }
    segment_.close(low_);
    return segment_;
  }
  [[nodiscard]] const Lslam& low() const { return low_; }
  [[nodiscard]] const Pose2& truth() const { return room_.map_T_scan(); }

 private:
  SimulatedRoom room_{4, 120};
  Lslam low_{low_params(), 1};
  RunSegment segment_;
};

TEST(RunSegment, HoldsThePathsOfTheLowLevelAndItsDriftGrowsEvenly) {
  LowRun run;
  static_cast<void>(run.next_segment());
  const RunSegment& segment = run.next_segment();
  double weights = 0.0;
  const Eigen::Vector3d drift(0.1, -0.2, 0.05);
  for (int path = 0; path < segment.paths(); ++path) {
    weights += segment.path_weight(path);
    std::vector<StampedPose> last(6);
    ASSERT_EQ(run.low().copy_last_poses(path, last), 6);
    for (int i = 0; i < segment.size(); ++i) {
      const Pose2 expected = last[0].map_T_scan.inverse() * last[static_cast<std::size_t>(i) + 1].map_T_scan;
      const Pose2 plain = segment.scan_pose(path, i, Eigen::Vector3d::Zero());
      EXPECT_LT(plain.distance_m(expected), 1e-12);
      const Pose2 drifted = segment.scan_pose(path, i, drift);
      EXPECT_NEAR(drifted.x_m - plain.x_m, 0.1 * (i + 1) / 5.0, 1e-12);
      EXPECT_NEAR(drifted.yaw_rad - plain.yaw_rad, 0.05 * (i + 1) / 5.0, 1e-12);
    }
  }
  EXPECT_NEAR(weights, 1.0, 1e-12);
  const Eigen::Matrix3d& covariance = segment.drift_covariance();
  EXPECT_TRUE(covariance.isApprox(covariance.transpose()));
  EXPECT_GT(covariance.determinant(), 0.0);
}

TEST(RunSegment, LongerWaysDriftMore) {
  LowRun small(3);
  LowRun large(10);
  EXPECT_GT(large.next_segment().drift_covariance()(2, 2), 2.0 * small.next_segment().drift_covariance()(2, 2));
}

TEST(HslamOracle, GivesTheBitsOfParticlesThatEachCopyTheirMap) {
  for (const double tempering : {0.02, 0.3}) {
    HslamParams params = high_params();
    params.tempering = tempering;
    Hslam hslam(params, 7);
    PlainSegments plain(params, 7);
    LowRun run;
    for (int i = 0; i < 12; ++i) {
      const RunSegment& segment = run.next_segment();
      hslam.begin(segment);
      while (!hslam.work(1)) {
      }
      plain.add(segment);
      for (int p = 0; p < params.particles; ++p) {
        const auto index = static_cast<std::size_t>(p);
        ASSERT_TRUE(same_pose(hslam.particles().pose(p), plain.particles()[index].map_T_scan)) << i << ", " << p;
        ASSERT_EQ(hslam.particles().weight(p), plain.weights()[index]) << i << ", " << p;
      }
    }
    EXPECT_GE(plain.resamplings(), tempering > 0.1 ? 4 : 1);
    std::vector<StampedPose> path;
    hslam.write_path(path);
    const auto best = static_cast<std::size_t>(hslam.particles().best());
    const std::vector<StampedPose>& expected = plain.particles()[best].path;
    ASSERT_EQ(path.size(), expected.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      ASSERT_TRUE(same_pose(path[i].map_T_scan, expected[i].map_T_scan));
    }
  }
}

TEST(Hslam, IsTheSameHoweverItIsSliced) {
  Hslam whole(high_params(), 3);
  Hslam sliced(high_params(), 3);
  LowRun run;
  for (int i = 0; i < 8; ++i) {
    const RunSegment& segment = run.next_segment();
    whole.begin(segment);
    EXPECT_TRUE(whole.work(whole.slices())) << "as many slices as it says are enough";
    sliced.begin(segment);
    int slices = 0;
    for (bool done = false; !done; slices += 1 + i % 5) {
      done = sliced.work(1 + i % 5);
      ASSERT_LE(slices, whole.slices());
    }
    EXPECT_TRUE(whole.idle() && sliced.idle());
    ASSERT_TRUE(same_pose(whole.best_pose(), sliced.best_pose())) << i;
    EXPECT_EQ(whole.report().segments, i + 1);
  }
}

TEST(Hslam, StaysOnTrack) {
  HslamParams params = high_params();
  params.particles = 30;
  Hslam hslam(params, 1);
  LowRun run;
  for (int i = 0; i < 40; ++i) {
    hslam.begin(run.next_segment());
    static_cast<void>(hslam.work(hslam.slices()));
    ASSERT_LT(hslam.best_pose().distance_m(run.truth()), 0.25) << i;
  }
}

TEST(Hslam, GoesOnFromWhereItIsPut) {
  Hslam hslam(high_params(), 1);
  LowRun run;
  hslam.begin(run.next_segment());
  static_cast<void>(hslam.work(hslam.slices()));
  const Pose2 put{1.5, -1.0, 2.0};
  hslam.set_pose(put);
  EXPECT_TRUE(same_pose(hslam.best_pose(), put));
  for (int i = 0; i < hslam.particles().size(); ++i) {
    EXPECT_TRUE(same_pose(hslam.particles().pose(i), put));
  }
}

}  // namespace
}  // namespace odoless
