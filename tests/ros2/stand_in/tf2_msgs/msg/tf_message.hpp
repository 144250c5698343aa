#pragma once

#include "tools/ros2/messages.hpp"

namespace tf2_msgs::msg {
using TFMessage = odoless::ros::TFMessage;
}
