// ROS's messages as odoless writes them, against the definitions that Debian has of ROS 1. ROS 2's are the same but for
// the header, which has no sequence number, and stamps, which are a message.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "firmware/lcm/messages.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/ros2/cdr.hpp"
#include "tools/ros2/definition.hpp"
#include "tools/ros2/messages.hpp"
#include "tools/ros2/odoless_ros2/include/odoless_ros2/conversion.hpp"

namespace odoless {
namespace {

using Fields = std::vector<std::string>;

/// "type name" of each field, as ROS 2 names types; without constants and comments.
Fields fields_of(const std::string& text) {
  Fields fields;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type;
    std::string name;
    if (!(words >> type >> name) || name.find('=') != std::string::npos || name == "seq") {
      continue;
    }
    static const std::map<std::string, std::string> kRenamed{{"time", "builtin_interfaces/Time"}, {"byte", "uint8"}};
    const auto renamed = kRenamed.find(type);
    fields.push_back((renamed == kRenamed.end() ? type.substr(type.find('/') + 1)
                                                : renamed->second.substr(renamed->second.find('/') + 1)) +
                     " " + name);
  }
  return fields;
}

/// Each message of a definition: its name and the text of its fields.
std::map<std::string, std::string> parts_of(const std::string& root, const std::string& definition) {
  std::map<std::string, std::string> parts;
  std::string name = root;
  std::istringstream lines(definition);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("MSG: ")) {
      name = line.substr(5);
    } else if (!line.starts_with("===")) {
      parts[name] += line + "\n";
    }
  }
  return parts;
}

template <class Message>
class RosMessage : public ::testing::Test {};
using Written = ::testing::Types<ros::LaserScan, ros::TFMessage, ros::PoseWithCovarianceStamped, ros::DiagnosticArray,
                                 ros::OccupancyGrid, ros::Path>;
TYPED_TEST_SUITE(RosMessage, Written);

TYPED_TEST(RosMessage, HasTheFieldsOfItsDefinition) {
  int compared = 0;
  for (const auto& [name, text] : parts_of(TypeParam::kType, ros::Definition::of<TypeParam>())) {
    if (name == ros::Time::kType) {
      EXPECT_EQ(text, "int32 sec\nuint32 nanosec\n");
      continue;
    }
    const std::size_t slash = name.find('/');
    const auto file =
        std::filesystem::path("/usr/share") / name.substr(0, slash) / "msg" / (name.substr(slash + 1) + ".msg");
    ASSERT_TRUE(std::filesystem::exists(file)) << file << ": tools/setup test installs it";
    EXPECT_EQ(fields_of(text), fields_of(read_whole_file(file))) << name;
    ++compared;
  }
  EXPECT_GE(compared, 2);
}

TEST(RosConversion, TransformsMultiplyToThePoseOfTheBase) {
  pose_estimate_t estimate{};
  estimate.utime = 12'345'678;
  estimate.pose[0] = 3.0;
  estimate.pose[1] = -2.0;
  estimate.pose[2] = 2.5;
  ros::TFMessage tree;
  ros::to_ros(estimate, Pose2{0.5, 0.2, -0.4}, {}, tree);
  ASSERT_EQ(tree.transforms.size(), 2U);
  EXPECT_EQ(tree.transforms[0].header.frame_id, "map");
  EXPECT_EQ(tree.transforms[0].child_frame_id, "odom");
  EXPECT_EQ(tree.transforms[1].header.frame_id, "odom");
  EXPECT_EQ(tree.transforms[1].child_frame_id, "base_link");
  EXPECT_EQ(tree.transforms[1].header.stamp.sec, 12);
  EXPECT_EQ(tree.transforms[1].header.stamp.nanosec, 345'678'000U);
  const auto pose = [](const ros::Transform& t) {
    return ros::pose_of(ros::Pose{{t.translation.x, t.translation.y, 0.0}, t.rotation});
  };
  const Pose2 map_T_base = pose(tree.transforms[0].transform) * pose(tree.transforms[1].transform);
  EXPECT_NEAR(map_T_base.distance_m({3.0, -2.0, 0.0}), 0.0, 1e-12);
  EXPECT_NEAR(map_T_base.yaw_rad, 2.5, 1e-12);
}

TEST(RosConversion, CovarianceIsThatOfTheBaseInTheMap) {
  pose_estimate_t estimate{};
  estimate.pose[2] = 0.8;
  for (int i = 0; i < 9; ++i) {
    estimate.covariance[i] = 1.0 + i;
  }
  ros::PoseWithCovarianceStamped told;
  ros::to_ros(estimate, {}, told);
  EXPECT_NEAR(ros::pose_of(told.pose.pose).yaw_rad, 0.8, 1e-12);
  std::array<double, 36> expected{};
  const std::array<std::size_t, 3> places{0, 1, 5};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      expected.at(6 * places.at(i) + places.at(j)) = 1.0 + static_cast<double>(3 * i + j);
    }
  }
  EXPECT_EQ(told.pose.covariance, expected);
}

TEST(RosConversion, ScansSayWhatWasNotHitAndWhatIsNotKnown) {
  bot_core::planar_lidar_t lidar{};
  lidar.ranges = {1.5F, std::numeric_limits<float>::infinity(), 0.0F, 25.0F, -1.0F};
  lidar.nranges = 5;
  lidar.rad0 = -1.0F;
  lidar.radstep = 0.5F;
  ros::LaserScan scan;
  ros::to_ros(lidar, {.scan_period_s = 0.1, .range_max_m = 20.0F}, {}, scan);
  EXPECT_EQ(scan.header.frame_id, "laser");
  EXPECT_EQ(scan.angle_max, 1.0F);
  EXPECT_EQ(scan.ranges[0], 1.5F);
  EXPECT_TRUE(std::isinf(scan.ranges[1]) && std::isinf(scan.ranges[3]));
  EXPECT_TRUE(std::isnan(scan.ranges[2]) && std::isnan(scan.ranges[4]));
}

TEST(RosConversion, AGridHasPercentAndUnknown) {
  ros::OccupancyGrid grid;
  const std::vector<std::uint8_t> cells{0, 50, 100, 255, 101, 7};
  ros::to_ros({.lower_left_x_m = -1.0, .lower_left_y_m = 2.0, .cell_size_m = 0.05, .columns = 3, .rows = 2}, cells, {},
              grid);
  EXPECT_EQ(grid.data, (std::vector<std::int8_t>{0, 50, 100, -1, -1, 7}));
  EXPECT_EQ(grid.info.width, 3U);
  EXPECT_EQ(grid.info.height, 2U);
  EXPECT_EQ(grid.info.origin.position.x, -1.0);
  EXPECT_EQ(grid.info.origin.orientation.w, 1.0);
}

TEST(RosConversion, DiagnosticsNameTheStateAndEveryReason) {
  HealthReport report;
  report.state = HealthState::kDegraded;
  for (int bit = 0; bit < 26; ++bit) {
    report.reasons = 1U << static_cast<unsigned>(bit);
    health_t health{};
    to_message(report, health);
    ros::DiagnosticArray told;
    ros::to_ros(health, told);
    EXPECT_EQ(told.status[0].level, 1);
    EXPECT_EQ(told.status[0].message, std::string("DEGRADED: ") + ros::reason_text(bit));
    EXPECT_NE(told.status[0].message, "DEGRADED: ");
  }
  EXPECT_EQ(ros::reason_text(26), std::string());
  const std::array<int, 5> levels{3, 0, 1, 2, 2};
  for (int state = 0; state < 5; ++state) {
    health_t health{};
    health.state = static_cast<std::int8_t>(state);
    ros::DiagnosticArray told;
    ros::to_ros(health, told);
    EXPECT_EQ(told.status[0].level, levels.at(static_cast<std::size_t>(state)));
  }
}

TEST(RosConversion, YawsOfAnyQuaternionComeBack) {
  for (double yaw_rad = -3.1; yaw_rad < 3.2; yaw_rad += 0.1) {
    ros::Pose pose;
    ros::set_pose(Pose2{1.0, 2.0, yaw_rad}, pose);
    EXPECT_NEAR(ros::pose_of(pose).yaw_rad, yaw_rad, 1e-12);
    bot_core::rigid_transform_t transform{};
    PoseRecord record;
    record.map_T_odom = {1.0, 2.0, yaw_rad};
    to_message(record, transform);
    EXPECT_NEAR(ros::pose_of(transform).yaw_rad, yaw_rad, 1e-12);
  }
}

}  // namespace
}  // namespace odoless
