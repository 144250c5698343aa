#include "core/slam/slam.hpp"

#include <algorithm>

namespace odoless {
namespace {

/// So that the poses of two segments are never among those that a full pool may thin.
LslamParams with_paths_for(LslamParams low, const HslamParams& high) {
  low.path_records_max = std::max(low.path_records_max, 6 * high.segment_updates * low.particles);
  return low;
}

}  // namespace

Slam::Slam(const SlamParams& params, const ScanParams& scan, std::uint64_t seed)
    : low_(with_paths_for(params.low, params.high), seed) {
  if (params.high.particles == 0) {
    return;
  }
  const int updates = params.high.segment_updates;
  high_.emplace(params.high, seed);
  segments_.assign(2, Segment(params.high.drift, updates, params.low.particles, scan));
  slices_per_call_ = (high_->slices() + updates - 1) / updates;
  last_.resize(2 * static_cast<std::size_t>(updates) + 1);
}

void Slam::reset(const Pose2& map_T_scan) {
  low_.reset(map_T_scan);
  updates_unfinished_ = updates_in_work_ = 0;
  if (high_) {
    high_->reset(map_T_scan);
    segments_[static_cast<std::size_t>(filling_)].clear();
  }
}

UpdateReport Slam::update(const MotionIncrement& increment, const ScanFrame& scan) {
  const UpdateReport report = low_.update(increment, scan);
  if (high_) {
    Segment& segment = segments_[static_cast<std::size_t>(filling_)];
    ++updates_unfinished_;
    segment.add(updates_unfinished_ == 1 && high_->report().segments == 0 ? MotionIncrement{} : increment, scan);
    if (segment.full()) {
      close_segment();
    }
  }
  return report;
}

void Slam::work() { run(slices_per_call_); }

void Slam::finish() {
  if (!high_) {
    return;
  }
  run(high_->slices());
  if (segments_[static_cast<std::size_t>(filling_)].size() > 0) {
    close_segment();
    run(high_->slices());
  }
}

Pose2 Slam::map_T_scan() const {
  const Pose2& low_T_scan = low_.pose(low_.best());
  if (!high_ || high_->report().segments == 0) {
    return low_T_scan;
  }
  return high_->best_pose() * (low_T_finished().inverse() * low_T_scan);
}

void Slam::write_occupancy(OccupancyMap& map) {
  if (high_ && high_->report().segments > 0) {
    high_->write_occupancy(map);
  } else {
    low_.write_occupancy(map);
  }
}

void Slam::write_path(std::vector<StampedPose>& path) const {
  low_.write_path(path);
  if (!high_ || high_->report().segments == 0) {
    return;
  }
  const auto unfinished = static_cast<std::ptrdiff_t>(updates_unfinished_);
  const Pose2 map_T_low = high_->best_pose() * low_T_finished().inverse();
  std::vector<StampedPose> whole;
  high_->write_path(whole);
  for (auto pose = path.end() - unfinished; pose != path.end(); ++pose) {
    whole.push_back({.stamp_ns = pose->stamp_ns, .map_T_scan = map_T_low * pose->map_T_scan});
  }
  path.swap(whole);
}

std::size_t Slam::memory_bytes() const {
  std::size_t bytes = sizeof(*this) + low_.memory_bytes() + last_.capacity() * sizeof(StampedPose);
  bytes += high_ ? high_->memory_bytes() : 0;
  for (const Segment& segment : segments_) {
    bytes += segment.memory_bytes();
  }
  return bytes;
}

/// Whatever HSLAM has not done of the segment before is done now: nothing is left if `work` was called as it should.
void Slam::close_segment() {
  run(high_->slices());
  Segment& segment = segments_[static_cast<std::size_t>(filling_)];
  segment.close(low_);
  updates_in_work_ = segment.size();
  high_->begin(segment);
  filling_ = 1 - filling_;
  segments_[static_cast<std::size_t>(filling_)].clear();
}

void Slam::run(int particles) {
  if (high_ && high_->work(particles)) {
    updates_unfinished_ -= updates_in_work_;
    updates_in_work_ = 0;
  }
}

Pose2 Slam::low_T_finished() const {
  const auto wanted = static_cast<std::size_t>(updates_unfinished_) + 1;
  static_cast<void>(low_.copy_last_poses(low_.best(), std::span(last_).first(wanted)));
  return last_[0].map_T_scan;
}

}  // namespace odoless
