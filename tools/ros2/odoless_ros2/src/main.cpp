#include <exception>
#include <odoless_ros2/bridge_node.hpp>

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  try {
    rclcpp::spin(std::make_shared<odoless::ros::BridgeNode>());
  } catch (const std::exception& error) {
    RCLCPP_FATAL(rclcpp::get_logger("odoless"), "%s", error.what());
    return 1;
  }
  rclcpp::shutdown();
  return 0;
}
