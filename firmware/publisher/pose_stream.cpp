#include "firmware/publisher/pose_stream.hpp"

#include <algorithm>
#include <utility>

namespace odoless {
namespace {

constexpr std::size_t kPiece = 4096;

}  // namespace

PoseStream::PoseStream(const PoseSpool& spool, std::size_t size, Change change)
    : spool_(&spool), size_(size), change_(std::move(change)), entries_(std::min(size, kPiece)) {
  poses_.resize(entries_.size());
}

std::span<const StampedPose> PoseStream::next() {
  const std::size_t count = std::min(entries_.size(), size_ - at_);
  const std::span<PoseSpool::Entry> entries(entries_.data(), count);
  const std::span<StampedPose> poses(poses_.data(), count);
  if (count == 0) {
    return {};
  }
  error_ = spool_->read(at_, entries);
  if (error_ != 0) {
    return {};
  }
  at_ += count;
  change_(entries, poses);
  return poses;
}

void take_online(std::span<const PoseSpool::Entry> entries, std::span<StampedPose> poses) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    poses[i] = {entries[i].stamp_ns, entries[i].map_T_scan};
  }
}

void take_odometry(std::span<const PoseSpool::Entry> entries, std::span<StampedPose> poses) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    poses[i] = {entries[i].stamp_ns, entries[i].odom_T_scan};
  }
}

PoseStream::Change take_final(std::vector<StampedPose> path) {
  return [path = std::move(path), at = std::size_t{0}](std::span<const PoseSpool::Entry> entries,
                                                       std::span<StampedPose> poses) mutable {
    for (std::size_t i = 0; i < entries.size(); ++i) {  // stamps only grow, in both
      const PoseSpool::Entry& entry = entries[i];
      while (at < path.size() && path[at].stamp_ns < entry.update_stamp_ns) {
        ++at;
      }
      const bool known = at < path.size() && path[at].stamp_ns == entry.update_stamp_ns;
      poses[i] = {entry.stamp_ns, known ? path[at].map_T_scan * entry.update_T_scan : entry.map_T_scan};
    }
  };
}

PoseStream::Change take_corrected(TrajectoryCorrection correction) {
  return [correction = std::move(correction)](std::span<const PoseSpool::Entry> entries,
                                              std::span<StampedPose> poses) mutable {
    take_odometry(entries, poses);
    correction.correct(poses);
  };
}

}  // namespace odoless
