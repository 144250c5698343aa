#pragma once

#include <string_view>

#include "tools/log/message_log.hpp"

namespace odoless {

/// How a recorder wrote a message of ROS.
enum class RosEncoding {
  kRos1,  ///< little end first, nothing between the fields
  kCdr,   ///< with a header of 4 bytes that says which end is first
};

/// Whether a message of this type is a scan, by ROS 1's name or ROS 2's.
[[nodiscard]] bool is_laser_scan(std::string_view type);

/// A sensor_msgs/LaserScan.
///
/// Its stamp is the header's, of the first beam; time_increment is the time from beam to beam. range_max and more, and
/// infinity, are no return; of NaN and of what is nearer than range_min nothing is known (REP 117). Intensities are
/// skipped.
[[nodiscard]] DecodedScan decode_laser_scan(std::string_view message, RosEncoding encoding);

}  // namespace odoless
