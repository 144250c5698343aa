#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// All poses of a run, kept in a file without a name, so that a long run needs no memory for them. What the disk does
/// not take waits, `kWaitingMax` poses, and is written when it does.
///
/// Thread: `add` is the publisher's; the rest is any's, and never waits for more than one write of what waits.
class PoseSpool {
 public:
  struct Entry {
    std::int64_t stamp_ns = 0;
    Pose2 map_T_scan{};
    std::int64_t update_stamp_ns = 0;
    Pose2 update_T_scan{};
    Pose2 odom_T_scan{};
  };
  static constexpr std::size_t kWaitingMax = 8192;

  /// @param folder  Where the file is; it goes with this object. Without one nothing is kept.
  explicit PoseSpool(const std::filesystem::path& folder);

  [[nodiscard]] bool is_kept() const { return file_.valid(); }
  void add(const PoseRecord& pose);

  /// Poses that can be read, after those that wait are written.
  [[nodiscard]] std::size_t size();
  /// Reads those from `first` on. @return  0 or errno.
  [[nodiscard]] int read(std::size_t first, std::span<Entry> entries) const;

  /// errno of the last write; 0: it went well.
  [[nodiscard]] int error() const { return error_; }

 private:
  void write_waiting();

  FileDescriptor file_;
  std::mutex mutex_;
  std::vector<Entry> waiting_;
  std::size_t written_ = 0;
  std::atomic<int> error_{0};
};

}  // namespace odoless
