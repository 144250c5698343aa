#include "firmware/daemon/daemon_params.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace odoless {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(DaemonParams, SaysWhichValuesDoNotGoTogether) {
  DaemonParams params;
  EXPECT_EQ(params.contradiction(), "");
  params.lrf.driver = LrfDriver::kRplidar;
  params.lrf.rplidar_beams = params.robot.scan.beams_max;
  EXPECT_EQ(params.contradiction(), "");
  ++params.lrf.rplidar_beams;
  EXPECT_THAT(params.contradiction(), AllOf(HasSubstr("lrf.rplidar_beams = 2049"), HasSubstr("scan.beams_max = 2048")));
  params.lrf.driver = LrfDriver::kLdrobot;
  params.lrf.ldrobot_beams = params.robot.scan.beams_max;
  EXPECT_EQ(params.contradiction(), "") << "of another laser";
  ++params.lrf.ldrobot_beams;
  EXPECT_THAT(params.contradiction(), AllOf(HasSubstr("lrf.ldrobot_beams = 2049"), HasSubstr("scan.beams_max = 2048")));
  params.lrf.driver = LrfDriver::kSick;
  EXPECT_EQ(params.contradiction(), "") << "of another laser";
  params.robot.scan.beams_max = 360;
  EXPECT_THAT(params.contradiction(), AllOf(HasSubstr("lrf.sick_variant has 361"), HasSubstr("scan.beams_max = 360")));
  params.lrf.sick_variant = SickVariant::k180By1;
  EXPECT_EQ(params.contradiction(), "");
}

}  // namespace
}  // namespace odoless
