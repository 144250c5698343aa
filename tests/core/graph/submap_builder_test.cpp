// Where submaps are cut, and what the odometry between them is taken to be off by.
#include "core/graph/submap_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/geometry/pose2_covariance.hpp"
#include "core/graph/keyframe_gate.hpp"
#include "core/graph/pose_graph.hpp"

namespace odoless {
namespace {

/// A step of the odometry with a deviation in each direction of the scan's axes.
Motion step(const Pose2& odom_T_previous, const Pose2& previous_T_current, double sd_x_m, double sd_y_m) {
  Motion motion = Motion::between(0, 100'000'000, previous_T_current);
  motion.odom_T_current = odom_T_previous * previous_T_current;
  const Eigen::Matrix3d covariance = Eigen::Vector3d(sd_x_m * sd_x_m, sd_y_m * sd_y_m, 1e-6).asDiagonal();
  motion.set_error(ErrorProcess::independent(previous_T_current, covariance));
  return motion;
}

/// Drives a builder and keeps what it gives.
class BuilderDrive {
 public:
  explicit BuilderDrive(const GraphParams& params = {}) : gate_(params), builder_(params), scan_(ScanParams{}) {
    const std::vector<float> ranges_m(32, 3.0F);
    EXPECT_EQ(scan_.assign({.start_angle_rad = -1.5, .angle_step_rad = 0.1, .ranges_m = ranges_m}), Errc::kOk);
  }

  void go(int scans, const Pose2& way, double sd_x_m = 0.005, double sd_y_m = 0.005, double probability = 1.0) {
    for (int i = 0; i < scans; ++i) {
      Motion motion = step(odom_T_scan_, started_ ? way : Pose2{}, sd_x_m, sd_y_m);
      motion.probability = probability;
      started_ = true;
      odom_T_scan_ = motion.odom_T_current;
      if (!gate_.add(motion, std::exchange(unknown_s, 0.0))) {
        continue;
      }
      Keyframe keyframe;
      std::vector<BeamCode> codes(static_cast<std::size_t>(gate_.beams(scan_)));
      gate_.encode(scan_, {}, keyframe, codes);
      gate_.accept();
      if (builder_.is_to_end(keyframe.since_last) && builder_.finish(store_)) {
        submaps.push_back(builder_.finished());
        odometry.push_back(builder_.odometry());
      }
      builder_.add(keyframe, codes, store_);
    }
  }

  std::vector<Submap> submaps;
  std::vector<OdometryStretch> odometry;
  double unknown_s = 0.0;  ///< with the next motion, as the filter would say
  [[nodiscard]] const KeyframeStore& store() const { return store_; }

 private:
  KeyframeStore store_{1000, 541};
  KeyframeGate gate_;
  SubmapBuilder builder_;
  ScanFrame scan_;
  Pose2 odom_T_scan_{};
  bool started_ = false;
};

TEST(SubmapBuilder, CutsAfterItsTravelWithKeyframesEverySoFar) {
  BuilderDrive drive;
  drive.go(301, {0.1, 0.0, 0.0});
  ASSERT_GE(drive.submaps.size(), 5U);
  for (const Submap& submap : drive.submaps) {
    EXPECT_GE(submap.keyframes, 12);
    EXPECT_LE(submap.keyframes, 15);
  }
}

TEST(SubmapBuilder, OdometryLeadsFromOriginToOrigin) {
  BuilderDrive drive;
  drive.go(400, {0.08, 0.01, 0.02});
  ASSERT_GE(drive.submaps.size(), 4U);
  for (std::size_t i = 1; i < drive.submaps.size(); ++i) {
    const Pose2 expected = drive.submaps[i - 1].odom_T_submap.inverse() * drive.submaps[i].odom_T_submap;
    EXPECT_LT(expected.distance_m(drive.odometry[i].start_T_end), 1e-9);
    EXPECT_NEAR(wrap_angle(expected.yaw_rad - drive.odometry[i].start_T_end.yaw_rad), 0.0, 1e-9);
  }
}

TEST(SubmapBuilder, KeyframesLieWhereTheirScansWere) {
  BuilderDrive drive;
  drive.go(200, {0.1, 0.0, 0.01});
  for (const Submap& submap : drive.submaps) {
    const int middle = submap.first_keyframe + submap.keyframes / 2;
    EXPECT_LT(drive.store().submap_T_scan(middle).distance_m({}), 1e-12);
    for (int k = submap.first_keyframe + 1; k < submap.first_keyframe + submap.keyframes; ++k) {
      const double apart_m = drive.store().submap_T_scan(k).distance_m(drive.store().submap_T_scan(k - 1));
      EXPECT_GT(apart_m, 0.3);
      EXPECT_LT(apart_m, 0.6);
    }
  }
}

TEST(SubmapBuilder, CutsBeforeAMotionThatIsNotCredibleAndBelievesItLittle) {
  BuilderDrive drive;
  drive.go(20, {0.1, 0.0, 0.0});
  drive.go(1, {0.1, 0.0, 0.0}, 0.005, 0.005, 0.3);
  ASSERT_EQ(drive.submaps.size(), 1U);
  drive.go(60, {0.1, 0.0, 0.0});
  ASSERT_EQ(drive.submaps.size(), 2U);
  EXPECT_TRUE(drive.odometry[1].is_torn());
  const Eigen::Matrix3d covariance = drive.odometry[1].constraint_covariance({});
  EXPECT_GE(covariance(0, 0), 1.0);
  EXPECT_GE(covariance(2, 2), 0.4);
}

TEST(SubmapBuilder, CutsAlsoWhereTheFilterHoldsThatTrackingBrokeOff) {
  BuilderDrive drive;
  drive.go(20, {0.1, 0.0, 0.0});
  drive.unknown_s = 5.0;
  drive.go(1, {});
  ASSERT_EQ(drive.submaps.size(), 1U);
  drive.go(60, {0.1, 0.0, 0.0});
  ASSERT_EQ(drive.submaps.size(), 2U);
  const RobotLimits limits;
  EXPECT_GE(std::sqrt(drive.odometry[1].constraint_covariance(limits)(0, 0)), 0.5 * limits.speed_max_mps * 5.0);
}

TEST(SubmapBuilder, CutsSoonerWhereTheOdometrySlips) {
  BuilderDrive drive;
  drive.go(60, {0.1, 0.0, 0.0}, 0.2, 0.005);
  BuilderDrive steady;
  steady.go(60, {0.1, 0.0, 0.0});
  EXPECT_GE(drive.submaps.size(), 4U);
  EXPECT_LE(steady.submaps.size(), 1U);
}

TEST(OdometryStretch, SlipsAddUpAsLengthsAndOtherErrorsAsSquares) {
  OdometryStretch slipping;
  OdometryStretch held;
  for (int i = 0; i < 100; ++i) {
    slipping = slipping.then(OdometryStretch::of(step({}, {0.1, 0.0, 0.0}, 0.15, 0.005)));
    held = held.then(OdometryStretch::of(step({}, {0.1, 0.0, 0.0}, 0.005, 0.005)));
  }
  const Eigen::Matrix3d slip = slipping.constraint_covariance({});
  EXPECT_NEAR(std::sqrt(slip(0, 0)), 10.0 * std::sqrt(0.5), 1.0);  // 100 times what a step slips by beyond 0.05 m
  EXPECT_LT(std::sqrt(slip(1, 1)), 0.3);
  EXPECT_LT(std::sqrt(held.constraint_covariance({})(0, 0)), 0.3);
}

TEST(OdometryStretch, ASlipGoesAlongWithATurn) {
  OdometryStretch stretch;
  for (int i = 0; i < 50; ++i) {
    stretch = stretch.then(OdometryStretch::of(step({}, {0.1, 0.0, 0.0}, 0.15, 0.005)));
  }
  const OdometryStretch turned = stretch.then(OdometryStretch::of(step({}, {0.0, 0.0, 1.5707963}, 0.005, 0.005)));
  EXPECT_NEAR(std::abs(turned.slip_m.y_m), std::abs(stretch.slip_m.x_m), 1e-6);
}

TEST(OdometryStretch, ARobotAtRestGathersNoError) {
  OdometryStretch stretch;
  for (int i = 0; i < 1000; ++i) {
    stretch = stretch.then(OdometryStretch::of(step({}, {1e-4, 0.0, 0.0}, 0.2, 0.2)));
  }
  EXPECT_LT(std::sqrt(stretch.constraint_covariance({})(0, 0)), 0.05);
}

}  // namespace
}  // namespace odoless
