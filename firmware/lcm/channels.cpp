#include "firmware/lcm/channels.hpp"

namespace odoless {

Channels::Channels(std::string_view prefix) {
  const auto named = [prefix](std::string_view name) { return std::string(prefix).append(name); };
  scan = named("SCAN");
  scan_again = named("SCAN_AGAIN");
  scan_times = times_channel(scan);
  lrf_raw_rx = named("LRF_RAW_RX");
  lrf_raw_tx = named("LRF_RAW_TX");
  tilt_raw_rx = named("TILT_RAW_RX");
  tilt_raw_tx = named("TILT_RAW_TX");
  gpio_raw_rx = named("GPIO_RAW_RX");
  gpio_raw_tx = named("GPIO_RAW_TX");
  tilt = named("TILT");
  motion = named("MOTION");
  motion_again = named("MOTION_AGAIN");
  pose = named("POSE");
  laser_pose = named("LASER_POSE");
  pose_covariance = named("POSE_COVARIANCE");
  map_to_odom = named("MAP_TO_ODOM");
  correction = named("CORRECTION");
  map_tile = named("MAP_TILE");
  map = named("MAP");
  health = named("HEALTH");
  cloud_health = named("CLOUD_HEALTH");
  world = named("WORLD");
  lrf_status = named("LRF_STATUS");
  scan_points = named("SCAN_POINTS");
  cloud = named("CLOUD");
}

bool Channels::is_taken(std::string_view channel) const {
  return channel == scan || channel == scan_again || channel == scan_times || channel == motion ||
         channel == motion_again;
}

std::string times_channel(std::string_view scan_channel) { return std::string(scan_channel).append("_TIMES"); }

}  // namespace odoless
