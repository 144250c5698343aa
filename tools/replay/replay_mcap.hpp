#pragma once

#include <filesystem>
#include <memory>

#include "tools/replay/replay.hpp"

namespace odoless {

/// A replay as a file for Foxglove, RViz and ROS 2: /scan, /pose with covariance, /tf (map -> odom -> laser) of each
/// scan, /diagnostics once a second and on each change of state, and /map and /path again and again as they grow, at
/// the end the final ones. Messages are ROS 2's (tools/ros2).
class ReplayMcap {
 public:
  /// @throws CannotCreateError; what it writes later throws IoError.
  explicit ReplayMcap(const std::filesystem::path& file);
  ~ReplayMcap();
  ReplayMcap(const ReplayMcap&) = delete;
  ReplayMcap& operator=(const ReplayMcap&) = delete;
  ReplayMcap(ReplayMcap&&) = delete;
  ReplayMcap& operator=(ReplayMcap&&) = delete;

  /// What writes each scan; valid as long as this.
  [[nodiscard]] ReplayWatcher watcher();

  void finish(const ReplayResult& result);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace odoless
