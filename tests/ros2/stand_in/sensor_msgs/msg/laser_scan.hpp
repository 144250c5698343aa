#pragma once

#include "tools/ros2/messages.hpp"

namespace sensor_msgs::msg {
using LaserScan = odoless::ros::LaserScan;
}
