#pragma once

#include "tools/ros2/messages.hpp"

namespace geometry_msgs::msg {
using PoseWithCovarianceStamped = odoless::ros::PoseWithCovarianceStamped;
}
