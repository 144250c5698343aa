#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// All poses of a run, kept in a file without a name, so that a long run needs no memory for them.
///
/// Thread: publisher thread while it runs, then whoever ends the run.
class PoseSpool {
 public:
  /// @param folder  Where the file is; it goes with this object. Without one nothing is kept.
  explicit PoseSpool(const std::filesystem::path& folder);

  void add(const PoseRecord& pose);

  /// As they were published at the time.
  [[nodiscard]] std::vector<StampedPose> online();
  /// odom_T_scan of each, in place of map_T_scan.
  [[nodiscard]] std::vector<StampedPose> odometry();
  /// As known at the end: each pose hangs on a filter update, and `path` says where that was. Poses whose update is
  /// not in the path stay as they were published.
  [[nodiscard]] std::vector<StampedPose> final(std::span<const StampedPose> path);

  /// errno of the last failure; 0: none.
  [[nodiscard]] int error() const { return error_; }

 private:
  struct Entry {
    std::int64_t stamp_ns = 0;
    Pose2 map_T_scan{};
    std::int64_t update_stamp_ns = 0;
    Pose2 update_T_scan{};
    Pose2 odom_T_scan{};
  };
  struct Closer {
    // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): it is the owner
    void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
  };
  [[nodiscard]] std::vector<Entry> read_all();

  std::unique_ptr<std::FILE, Closer> file_;
  int error_ = 0;
};

}  // namespace odoless
