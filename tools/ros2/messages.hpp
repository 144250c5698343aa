#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace odoless::ros {

/// ROS 2's messages as far as odoless writes them, with the fields, order and types of their definitions (tests/tools/
/// ros_messages_test.cpp holds them against Debian's). Metres, radians, seconds. `describe` names each field once: what
/// encodes a message (cdr.hpp) and what tells a reader its layout (definition.hpp) are made of that.

struct Time {
  static constexpr const char* kType = "builtin_interfaces/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("sec", self.sec);
    visit("nanosec", self.nanosec);
  }
};

struct Header {
  static constexpr const char* kType = "std_msgs/Header";
  Time stamp{};
  std::string frame_id{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("stamp", self.stamp);
    visit("frame_id", self.frame_id);
  }
};

struct LaserScan {
  static constexpr const char* kType = "sensor_msgs/LaserScan";
  Header header{};
  float angle_min = 0.0F;
  float angle_max = 0.0F;
  float angle_increment = 0.0F;
  float time_increment = 0.0F;
  float scan_time = 0.0F;
  float range_min = 0.0F;
  float range_max = 0.0F;
  std::vector<float> ranges{};
  std::vector<float> intensities{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("angle_min", self.angle_min);
    visit("angle_max", self.angle_max);
    visit("angle_increment", self.angle_increment);
    visit("time_increment", self.time_increment);
    visit("scan_time", self.scan_time);
    visit("range_min", self.range_min);
    visit("range_max", self.range_max);
    visit("ranges", self.ranges);
    visit("intensities", self.intensities);
  }
};

/// Point and Vector3 are alike but for their names.
struct Point {
  static constexpr const char* kType = "geometry_msgs/Point";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
};

struct Vector3 : Point {
  static constexpr const char* kType = "geometry_msgs/Vector3";
};

struct Quaternion {
  static constexpr const char* kType = "geometry_msgs/Quaternion";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
    visit("w", self.w);
  }
};

struct Pose {
  static constexpr const char* kType = "geometry_msgs/Pose";
  Point position{};
  Quaternion orientation{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
  }
};

struct PoseStamped {
  static constexpr const char* kType = "geometry_msgs/PoseStamped";
  Header header{};
  Pose pose{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("pose", self.pose);
  }
};

struct PoseWithCovariance {
  static constexpr const char* kType = "geometry_msgs/PoseWithCovariance";
  Pose pose{};
  std::array<double, 36> covariance{};  ///< over x, y, z and the rotations about them, row by row

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("pose", self.pose);
    visit("covariance", self.covariance);
  }
};

struct PoseWithCovarianceStamped {
  static constexpr const char* kType = "geometry_msgs/PoseWithCovarianceStamped";
  Header header{};
  PoseWithCovariance pose{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("pose", self.pose);
  }
};

struct Transform {
  static constexpr const char* kType = "geometry_msgs/Transform";
  Vector3 translation{};
  Quaternion rotation{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("translation", self.translation);
    visit("rotation", self.rotation);
  }
};

struct TransformStamped {
  static constexpr const char* kType = "geometry_msgs/TransformStamped";
  Header header{};
  std::string child_frame_id{};
  Transform transform{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("child_frame_id", self.child_frame_id);
    visit("transform", self.transform);
  }
};

struct TFMessage {
  static constexpr const char* kType = "tf2_msgs/TFMessage";
  std::vector<TransformStamped> transforms{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("transforms", self.transforms);
  }
};

struct Path {
  static constexpr const char* kType = "nav_msgs/Path";
  Header header{};
  std::vector<PoseStamped> poses{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("poses", self.poses);
  }
};

struct MapMetaData {
  static constexpr const char* kType = "nav_msgs/MapMetaData";
  Time map_load_time{};
  float resolution = 0.0F;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose origin{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("map_load_time", self.map_load_time);
    visit("resolution", self.resolution);
    visit("width", self.width);
    visit("height", self.height);
    visit("origin", self.origin);
  }
};

struct OccupancyGrid {
  static constexpr const char* kType = "nav_msgs/OccupancyGrid";
  Header header{};
  MapMetaData info{};
  std::vector<std::int8_t> data{};  ///< percent, -1: unknown; row by row from the lowest y

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("info", self.info);
    visit("data", self.data);
  }
};

struct KeyValue {
  static constexpr const char* kType = "diagnostic_msgs/KeyValue";
  std::string key{};
  std::string value{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("key", self.key);
    visit("value", self.value);
  }
};

struct DiagnosticStatus {
  static constexpr const char* kType = "diagnostic_msgs/DiagnosticStatus";
  std::uint8_t level = 0;
  std::string name{};
  std::string message{};
  std::string hardware_id{};
  std::vector<KeyValue> values{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("level", self.level);
    visit("name", self.name);
    visit("message", self.message);
    visit("hardware_id", self.hardware_id);
    visit("values", self.values);
  }
};

struct DiagnosticArray {
  static constexpr const char* kType = "diagnostic_msgs/DiagnosticArray";
  Header header{};
  std::vector<DiagnosticStatus> status{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("header", self.header);
    visit("status", self.status);
  }
};

}  // namespace odoless::ros
