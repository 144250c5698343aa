// The bridge of tools/ros2/odoless_ros2 with stand-ins for ROS 2, which Debian does not have: what is published over
// LCM comes out as ROS's topics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <odoless_ros2/bridge_node.hpp>

#include "firmware/daemon/control_command.hpp"
#include "firmware/daemon/control_server.hpp"
#include "firmware/lcm/deflater.hpp"
#include "firmware/lcm/messages.hpp"
#include "rt/cpu_clock.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

constexpr const char* kUrl = "udpm://239.255.76.67:7791?ttl=0";
constexpr auto kPatience = std::chrono::seconds(5);

std::size_t count(const std::string& topic) {
  const std::scoped_lock lock(rclcpp::world().mutex);
  return rclcpp::world().published[topic].size();
}

template <class Message>
Message last(const std::string& topic) {
  const std::scoped_lock lock(rclcpp::world().mutex);
  return std::any_cast<Message>(rclcpp::world().published[topic].back());
}

occ_map::pixel_map_t map_of(const std::vector<std::uint8_t>& cells, int columns) {
  occ_map::pixel_map_t map{};
  map.dimensions[0] = columns;
  map.dimensions[1] = static_cast<int>(cells.size()) / columns;
  map.mpp = 0.1;
  map.data_type = occ_map::pixel_map_t::TYPE_UINT8;
  map.compressed = 1;
  map.mapData.resize(1000);
  Deflater deflater;
  map.mapData.resize(deflater.deflate(cells, map.mapData).value());
  map.datasize = static_cast<int>(map.mapData.size());
  return map;
}

class Bridge : public ::testing::Test {
 protected:
  void SetUp() override {
    rclcpp::world().published.clear();
    rclcpp::world().logged.clear();
    rclcpp::world().parameters = {{"lcm_url", std::string(kUrl)},
                                  {"control_socket", socket()},
                                  {"base_to_laser", std::vector<double>{0.2, 0.0, 0.0}}};
    node_ = std::make_unique<ros::BridgeNode>();
  }
  [[nodiscard]] std::string socket() const { return (folder_.path() / "control").string(); }

  /// Sends until `topic` has something.
  template <class Send>
  void send_until(const std::string& topic, const Send& send) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (count(topic) == 0 && std::chrono::steady_clock::now() < end) {
      send();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ASSERT_GT(count(topic), 0U) << topic;
  }

  test::TemporaryFolder folder_;
  lcm::LCM lcm_{kUrl};
  std::unique_ptr<ros::BridgeNode> node_;
};

TEST_F(Bridge, PosesAndFramesAreThoseOfTheBase) {
  PoseRecord record;
  record.stamp_ns = 1'700'000'000'500'000'000;
  record.map_T_scan = {5.0, 1.0, 0.0};
  record.map_T_odom = {1.0, 1.0, 0.0};
  pose_estimate_t estimate{};
  bot_core::rigid_transform_t map_to_odom{};
  to_message(record, estimate);
  to_message(record, map_to_odom);
  send_until("/tf", [&] {
    lcm_.publish("ODOLESS_POSE_COVARIANCE", &estimate);
    lcm_.publish("ODOLESS_MAP_TO_ODOM", &map_to_odom);
  });
  const auto pose = last<ros::PoseWithCovarianceStamped>("pose");
  EXPECT_NEAR(pose.pose.pose.position.x, 5.0, 1e-12);
  const auto tree = last<ros::TFMessage>("/tf");
  EXPECT_EQ(tree.transforms.at(0).transform.translation.x, 1.0);
  EXPECT_NEAR(tree.transforms.at(1).transform.translation.x, 4.0, 1e-12);
  EXPECT_EQ(last<ros::TFMessage>("/tf_static").transforms.at(0).transform.translation.x, 0.2);
}

TEST_F(Bridge, ATransformOfAnotherScanIsLeftOut) {
  pose_estimate_t estimate{};
  estimate.utime = 7;
  bot_core::rigid_transform_t map_to_odom{};
  map_to_odom.utime = 8;
  send_until("pose", [&] {
    lcm_.publish("ODOLESS_MAP_TO_ODOM", &map_to_odom);
    lcm_.publish("ODOLESS_POSE_COVARIANCE", &estimate);
    lcm_.publish("ODOLESS_MAP_TO_ODOM", &map_to_odom);
  });
  EXPECT_EQ(count("/tf"), 0U);
}

TEST_F(Bridge, MapsScansAndHealthComeThrough) {
  const occ_map::pixel_map_t map = map_of({0, 100, 255, 50, 7, 8}, 3);
  send_until("map", [&] { lcm_.publish("ODOLESS_MAP", &map); });
  EXPECT_EQ(last<ros::OccupancyGrid>("map").data, (std::vector<std::int8_t>{0, 100, -1, 50, 7, 8}));
  bot_core::planar_lidar_t scan{};
  scan.ranges = {1.0F, 50.0F};
  scan.nranges = 2;
  scan_times_t times{};
  times.beam_period_ns = 50'000;
  send_until("scan", [&] {
    lcm_.publish("ODOLESS_SCAN_TIMES", &times);
    lcm_.publish("ODOLESS_SCAN", &scan);
  });
  EXPECT_FLOAT_EQ(last<ros::LaserScan>("scan").time_increment, 50e-6F);
  EXPECT_TRUE(std::isinf(last<ros::LaserScan>("scan").ranges.at(1)));
  health_t health{};
  health.state = health_t::LOST;
  send_until("/diagnostics", [&] { lcm_.publish("ODOLESS_HEALTH", &health); });
  EXPECT_EQ(last<ros::DiagnosticArray>("/diagnostics").status.at(0).message, "LOST");
}

TEST(BridgeMap, WhatIsNoMapIsRefused) {
  const occ_map::pixel_map_t whole = map_of({0, 100, 255, 50, 7, 8}, 3);
  ros::OccupancyGrid out;
  ASSERT_TRUE(ros::to_ros(whole, {}, out));
  for (int kind = 0; kind < 7; ++kind) {
    occ_map::pixel_map_t map = whole;
    switch (kind) {
      case 0:
        map.dimensions[0] = 4;
        break;
      case 1:
        map.dimensions[0] = map.dimensions[1] = 2'000'000'000;
        break;
      case 2:
        map.dimensions[1] = -2;
        break;
      case 3:
        map.mapData.resize(3);
        break;
      case 4:
        map.compressed = 0;
        break;
      case 5:
        map.mpp = std::numeric_limits<double>::quiet_NaN();
        break;
      default:
        map.data_type = occ_map::pixel_map_t::TYPE_FLOAT;
    }
    EXPECT_FALSE(ros::to_ros(map, {}, out)) << kind;
  }
}

TEST_F(Bridge, AnInitialPoseBecomesTheDaemonsCommand) {
  ControlServer server;
  ASSERT_EQ(server.open(socket()), 0);
  std::string asked;
  std::atomic<bool> over = false;
  std::thread daemon([&] {
    while (!over) {
      server.serve(monotonic_ns(), [&asked](std::string_view command, const ControlPeer&) {
        asked = command;
        return std::string("done\n");
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  ros::PoseWithCovarianceStamped pose;
  pose.header.frame_id = "map";
  ros::set_pose(Pose2{3.0, -1.0, 0.5 * std::numbers::pi}, pose.pose.pose);
  rclcpp::world().listeners.at("initialpose")(pose);
  over = true;
  daemon.join();
  const auto command = parse_control_command(asked);
  ASSERT_TRUE(std::holds_alternative<ControlCommand>(command)) << asked;
  const Pose2 map_T_base = std::get<ControlCommand>(command).map_T_robot;
  EXPECT_NEAR(map_T_base.distance_m({3.0, -1.0, 0.0}), 0.0, 1e-5);
  EXPECT_NEAR(map_T_base.yaw_rad, 0.5 * std::numbers::pi, 1e-6);
  EXPECT_THAT(rclcpp::world().logged.back(), HasSubstr("done"));
}

TEST_F(Bridge, AnInitialPoseThatCannotBeSentSaysWhy) {
  ros::PoseWithCovarianceStamped pose;
  pose.header.frame_id = "map";
  rclcpp::world().listeners.at("initialpose")(pose);
  EXPECT_THAT(rclcpp::world().logged.back(), HasSubstr("No such file"));
  pose.header.frame_id = "odom";
  rclcpp::world().listeners.at("initialpose")(pose);
  EXPECT_THAT(rclcpp::world().logged.back(), HasSubstr("a finite pose in the frame map is needed"));
}

}  // namespace
}  // namespace odoless
