#include "core/odometry/map_slip.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odoless {
namespace {

Eigen::Matrix2d covariance(double x_sd_m, double y_sd_m) {
  return Eigen::Vector2d(x_sd_m * x_sd_m, y_sd_m * y_sd_m).asDiagonal();
}

const Eigen::Matrix2d kFirm = covariance(0.02, 0.01);
const Eigen::Matrix2d kWall = covariance(2.0, 0.01);

class MapSlipTest : public testing::Test {
 protected:
  // A scan is matched and becomes a key scan of the map that the next ones are matched with.
  double take_key(const Eigen::Matrix2d& held, const Eigen::Matrix2d& error) {
    const double slip_m = match(held, error);
    slip_.begin_map();
    slip_.take_map();
    return slip_m;
  }
  double match(const Eigen::Matrix2d& held, const Eigen::Matrix2d& error) {
    last_ = slip_.match(held, error);
    return std::sqrt(last_.trace());
  }

  MapSlip slip_;
  Eigen::Matrix2d last_;
};

TEST_F(MapSlipTest, IsNoneWhereOlderScansHoldTheNewest) {
  EXPECT_EQ(match(kFirm, covariance(0.3, 0.3)), 0.0) << "the first map has no newer scan";
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(take_key(kFirm, covariance(0.015, 0.015)), 0.0) << i;
  }
}

TEST_F(MapSlipTest, IsNoneAlongAWallThatGoesOnOrComesBack) {
  EXPECT_EQ(take_key(kFirm, kFirm), 0.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(take_key(kWall, covariance(0.4, 0.01)), 0.0) << i;
  }
  EXPECT_EQ(match(kWall, covariance(0.4, 0.01)), 0.0);
  EXPECT_EQ(match(kFirm, covariance(0.02, 0.01)), 0.0) << "of that map's older scans";
}

TEST_F(MapSlipTest, IsTheErrorOfTheScanThatHoldsWhatTheOlderOnesDidNot) {
  EXPECT_EQ(take_key(kWall, covariance(0.4, 0.01)), 0.0);
  EXPECT_NEAR(match(kFirm, covariance(0.02, 0.01)), 0.4 * (1.0 - 1e-4), 1e-6);
  EXPECT_GT(last_(0, 0), 0.15) << "along the wall";
  EXPECT_LT(last_(1, 1), 1e-12) << "and not across";
  EXPECT_EQ(match(kFirm, covariance(0.02, 0.01)), 0.0) << "once";
}

TEST_F(MapSlipTest, IsTheLessTheBetterTheOlderScansHeldIt) {
  double last_slip_m = 0.0;
  for (const double held_m : {0.1, 0.2, 0.5, 2.0}) {
    slip_.reset();
    EXPECT_EQ(take_key(covariance(held_m, 0.01), covariance(0.09, 0.01)), 0.0);
    const double slip_m = match(covariance(0.05, 0.01), covariance(0.04, 0.01));
    EXPECT_GT(slip_m, last_slip_m) << held_m;
    last_slip_m = slip_m;
  }
  EXPECT_LT(last_slip_m, 0.09);
}

TEST_F(MapSlipTest, IsOfTheLargestErrorSinceAScanWasHeldWell) {
  EXPECT_EQ(match(kFirm, kFirm), 0.0);
  EXPECT_EQ(match(kWall, covariance(0.5, 0.01)), 0.0);
  EXPECT_EQ(take_key(covariance(0.6, 0.01), covariance(0.2, 0.01)), 0.0) << "weak matches agree, which mends nothing";
  EXPECT_GT(match(kFirm, kFirm), 0.49);
  EXPECT_EQ(match(kFirm, kFirm), 0.0);
  EXPECT_EQ(take_key(kWall, covariance(0.1, 0.01)), 0.0);
  EXPECT_NEAR(match(kFirm, kFirm), 0.1, 1e-3) << "the one before is accounted for";
}

TEST_F(MapSlipTest, IsNotToldAgainByTheNextMapWhereAMatchThatHoldsBadlyToldItAlready) {
  EXPECT_EQ(take_key(kWall, covariance(0.4, 0.01)), 0.0);
  EXPECT_GT(take_key(covariance(0.3, 0.01), covariance(0.2, 0.01)), 0.35);
  EXPECT_NEAR(match(kFirm, kFirm), 0.2, 0.005) << "what is new since";
}

TEST_F(MapSlipTest, IsNoneOfAMapThatBeganAnew) {
  EXPECT_EQ(match(kWall, covariance(0.5, 0.01)), 0.0);
  slip_.reset();
  slip_.begin_map();
  slip_.take_map();
  EXPECT_EQ(match(kFirm, kFirm), 0.0);
}

TEST_F(MapSlipTest, IsOfTheMapThatIsMatchedWithWhileTheNextIsMade) {
  EXPECT_EQ(match(kWall, covariance(0.4, 0.01)), 0.0);
  slip_.begin_map();
  EXPECT_EQ(match(kWall, covariance(0.4, 0.01)), 0.0) << "still the old one";
  slip_.take_map();
  EXPECT_GT(match(kFirm, kFirm), 0.39);
}

}  // namespace
}  // namespace odoless
