#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "tools/log/byte_stream.hpp"
#include "tools/log/message_log.hpp"

namespace odoless {

/// What the readers here take for scans, for people.
inline constexpr const char* kScanTypes =
    "sensor_msgs/LaserScan, bot_core.planar_lidar_t or CObservation2DRangeScan messages";

/// Each pair: whether a file begins as one of the format, and its reader. README.md has the formats.
[[nodiscard]] bool is_lcm_log(std::string_view head);
[[nodiscard]] std::unique_ptr<MessageLog> open_lcm_log(std::unique_ptr<ByteStream> bytes,
                                                       const std::filesystem::path& path);

[[nodiscard]] bool is_ros_bag(std::string_view head);
[[nodiscard]] std::unique_ptr<MessageLog> open_ros_bag(std::unique_ptr<ByteStream> bytes,
                                                       const std::filesystem::path& path);

[[nodiscard]] bool is_mcap(std::string_view head);
[[nodiscard]] std::unique_ptr<MessageLog> open_mcap(std::unique_ptr<ByteStream> bytes,
                                                    const std::filesystem::path& path);

/// Reads the file at `path` itself, as SQLite does; the bytes are not used.
[[nodiscard]] bool is_sqlite_bag(std::string_view head);
[[nodiscard]] std::unique_ptr<MessageLog> open_sqlite_bag(std::unique_ptr<ByteStream> bytes,
                                                          const std::filesystem::path& path);

[[nodiscard]] bool is_rawlog(std::string_view head);
[[nodiscard]] std::unique_ptr<MessageLog> open_rawlog(std::unique_ptr<ByteStream> bytes,
                                                      const std::filesystem::path& path);

}  // namespace odoless
