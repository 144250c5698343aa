#pragma once

#include "tools/ros2/messages.hpp"

namespace diagnostic_msgs::msg {
using DiagnosticArray = odoless::ros::DiagnosticArray;
}
