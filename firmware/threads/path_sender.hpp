#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/slam/slam.hpp"
#include "firmware/pipeline/outbox.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// Tells the publisher now and then the trajectory as known now, for a cloud of points that hangs on it.
///
/// Thread: filter thread. Real time: no allocation; copies at most kPoses poses every kUpdates filter updates.
class PathSender {
 public:
  static constexpr std::size_t kPoses = 4096;  ///< of the last updates: some 800 m
  static constexpr int kUpdates = 16;

  void send(Outbox& outbox, const Slam& slam, std::int64_t stamp_ns) {
    if (++updates_ % kUpdates != 0) {
      return;
    }
    const std::span<std::byte> room =
        outbox.reserve(RecordType::kPath, sizeof(PathRecord) + kPoses * sizeof(StampedPose));
    if (room.empty()) {
      return;
    }
    const PathRecord record{stamp_ns};
    std::memcpy(room.data(), &record, sizeof(record));
    auto* const poses = reinterpret_cast<StampedPose*>(room.data() + sizeof(PathRecord));
    const int count = slam.copy_last_poses(std::span(poses, kPoses));
    if (count > 0) {
      outbox.commit(sizeof(PathRecord) + static_cast<std::size_t>(count) * sizeof(StampedPose));
    }
  }

 private:
  int updates_ = 0;
};

}  // namespace odoless
