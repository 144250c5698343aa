#pragma once

#include "tools/ros2/messages.hpp"

namespace nav_msgs::msg {
using OccupancyGrid = odoless::ros::OccupancyGrid;
}
