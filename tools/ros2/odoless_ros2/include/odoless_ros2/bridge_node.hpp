#pragma once

#include <atomic>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <odoless/scan_times_t.hpp>
#include <odoless_ros2/control.hpp>
#include <odoless_ros2/conversion.hpp>
#include <odoless_ros2/pixel_map.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <stdexcept>
#include <string>
#include <tf2_msgs/msg/tf_message.hpp>
#include <thread>
#include <vector>

namespace odoless::ros {

/// The daemon's messages as ROS's topics, and /initialpose as a command to the daemon. README.md lists them.
///
/// Threads: LCM's messages come on one of its own, which publishes them; /initialpose comes on the executor's.
class BridgeNode : public rclcpp::Node {
 public:
  BridgeNode() : Node("odoless"), lcm_(declare_parameter<std::string>("lcm_url", "")) {
    if (!lcm_.good()) {
      throw std::runtime_error("LCM cannot be opened: is lcm_url as the daemon's lcm.url?");
    }
    frames_.map = declare_parameter<std::string>("map_frame", frames_.map);
    frames_.odom = declare_parameter<std::string>("odom_frame", frames_.odom);
    frames_.base = declare_parameter<std::string>("base_frame", frames_.base);
    frames_.laser = declare_parameter<std::string>("laser_frame", frames_.laser);
    extent_.range_max_m = static_cast<float>(declare_parameter<double>("range_max_m", 30.0));
    socket_ = declare_parameter<std::string>("control_socket", "/run/odoless/control");
    const auto mount = declare_parameter<std::vector<double>>("base_to_laser", {0.0, 0.0, 0.0});
    if (mount.size() != 3) {
      throw std::runtime_error("base_to_laser: must be x and y in metres and yaw in radians");
    }
    base_T_laser_ = {mount[0], mount[1], mount[2]};
    advertise();
    subscribe(declare_parameter<std::string>("lcm_prefix", "ODOLESS_"));
    listener_ = std::thread([this] { listen(); });
  }

  ~BridgeNode() override {
    stopping_ = true;
    listener_.join();
  }

 private:
  void advertise() {
    const auto kept = rclcpp::QoS(1).transient_local();  // who comes late has the last one, as of a map server
    map_ = create_publisher<nav_msgs::msg::OccupancyGrid>("map", kept);
    mount_ = create_publisher<tf2_msgs::msg::TFMessage>("/tf_static", kept);
    transforms_ = create_publisher<tf2_msgs::msg::TFMessage>("/tf", rclcpp::QoS(100));
    pose_ = create_publisher<geometry_msgs::msg::PoseWithCovarianceStamped>("pose", rclcpp::QoS(10));
    scan_ = create_publisher<sensor_msgs::msg::LaserScan>("scan", rclcpp::SensorDataQoS());
    diagnostics_ = create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", rclcpp::QoS(10));
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms.resize(1);
    set_transform(0, frames_.base, frames_.laser, base_T_laser_, fixed.transforms.front());
    mount_->publish(fixed);
    using Initial = geometry_msgs::msg::PoseWithCovarianceStamped;
    initial_ = create_subscription<Initial>("initialpose", rclcpp::QoS(1), [this](const Initial& pose) { put(pose); });
  }

  void subscribe(const std::string& prefix) {
    lcm_.subscribe(prefix + "POSE_COVARIANCE", &BridgeNode::take_pose, this);
    lcm_.subscribe(prefix + "MAP_TO_ODOM", &BridgeNode::take_map_to_odom, this);
    lcm_.subscribe(prefix + "MAP", &BridgeNode::take_map, this);
    lcm_.subscribe(prefix + "SCAN", &BridgeNode::take_scan, this);
    lcm_.subscribe(prefix + "SCAN_TIMES", &BridgeNode::take_scan_times, this);
    lcm_.subscribe(prefix + "HEALTH", &BridgeNode::take_health, this);
  }

  void listen() {
    constexpr int kPatience_ms = 100;
    while (!stopping_) {
      lcm_.handleTimeout(kPatience_ms);
    }
  }

  void take_pose(const lcm::ReceiveBuffer*, const std::string&, const pose_estimate_t* estimate) {
    estimate_ = *estimate;
    geometry_msgs::msg::PoseWithCovarianceStamped pose;
    to_ros(*estimate, frames_, pose);
    pose_->publish(pose);
  }

  /// Comes behind the pose of the same scan.
  void take_map_to_odom(const lcm::ReceiveBuffer*, const std::string&, const bot_core::rigid_transform_t* transform) {
    if (transform->utime == estimate_.utime) {
      tf2_msgs::msg::TFMessage transforms;
      to_ros(estimate_, pose_of(*transform), frames_, transforms);
      transforms_->publish(transforms);
    }
  }

  void take_map(const lcm::ReceiveBuffer*, const std::string&, const occ_map::pixel_map_t* pixels) {
    nav_msgs::msg::OccupancyGrid map;
    if (to_ros(*pixels, frames_, map)) {
      map_->publish(map);
    } else {
      RCLCPP_WARN(get_logger(), "a map that is none was refused");
    }
  }

  void take_scan(const lcm::ReceiveBuffer*, const std::string&, const bot_core::planar_lidar_t* lidar) {
    sensor_msgs::msg::LaserScan scan;
    to_ros(*lidar, extent_, frames_, scan);
    scan_->publish(scan);
  }

  void take_scan_times(const lcm::ReceiveBuffer*, const std::string&, const scan_times_t* times) {
    extent_.beam_period_s = 1e-9 * static_cast<double>(times->beam_period_ns);
  }

  void take_health(const lcm::ReceiveBuffer*, const std::string&, const health_t* health) {
    diagnostic_msgs::msg::DiagnosticArray diagnostics;
    to_ros(*health, diagnostics);
    diagnostics_->publish(diagnostics);
  }

  void put(const geometry_msgs::msg::PoseWithCovarianceStamped& pose) {
    const std::string command = initial_pose_command(pose, frames_);
    if (command.empty()) {
      RCLCPP_ERROR(get_logger(), "initialpose: a finite pose in the frame %s is needed", frames_.map.c_str());
      return;
    }
    RCLCPP_INFO(get_logger(), "%s: %s", command.c_str(), ask_daemon(socket_, command).c_str());
  }

  lcm::LCM lcm_;
  Frames frames_;
  ScanExtent extent_;
  Pose2 base_T_laser_;
  std::string socket_;
  pose_estimate_t estimate_{};
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr map_;
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr mount_;
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr transforms_;
  rclcpp::Publisher<geometry_msgs::msg::PoseWithCovarianceStamped>::SharedPtr pose_;
  rclcpp::Publisher<sensor_msgs::msg::LaserScan>::SharedPtr scan_;
  rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr diagnostics_;
  rclcpp::Subscription<geometry_msgs::msg::PoseWithCovarianceStamped>::SharedPtr initial_;
  std::atomic<bool> stopping_ = false;
  std::thread listener_;
};

}  // namespace odoless::ros
