#include "core/slam/slam.hpp"

#include <algorithm>

#include "core/geometry/pose2_covariance.hpp"

namespace odoless {
namespace {

/// So that the poses of two segments are never among those that a full pool may thin.
LslamParams with_paths_for(LslamParams low, const HslamParams& high) {
  low.path_records_max = std::max(low.path_records_max, 6 * high.segment_updates * low.particles);
  return low;
}

}  // namespace

Slam::Slam(const SlamParams& params, const ScanParams& scan, std::uint64_t seed)
    : params_(params), low_(with_paths_for(params.low, params.high), seed) {
  if (params.high.particles == 0) {
    return;
  }
  const int updates = params.high.segment_updates;
  high_.emplace(params.high, seed);
  segments_.assign(2, RunSegment(params.high.drift, updates, params.low.particles, scan));
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

void Slam::set_pose(const Pose2& map_T_scan, const PoseSpread& spread) {
  if (high_) {
    finish();
    high_->set_pose(map_T_scan, spread);  // the low level goes on in its own frame, now placed anew in the map
  } else {
    low_.set_pose(map_T_scan, spread);
  }
}

bool Slam::settle() {
  if (!high_) {
    return true;
  }
  work();
  if (high_->idle() && segments_[static_cast<std::size_t>(filling_)].size() > 0) {
    close_segment();
  }
  return high_->idle();
}

UpdateReport Slam::update(const Motion& motion, const ScanFrame& scan, const Deadline& deadline) {
  const UpdateReport report = low_.update(motion, scan, deadline);
  if (high_) {
    RunSegment& segment = segments_[static_cast<std::size_t>(filling_)];
    ++updates_unfinished_;
    segment.add(updates_unfinished_ == 1 && high_->report().segments == 0 ? Motion{} : motion, scan);
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
  return has_segments() ? map_T_low() * low_T_scan : low_T_scan;
}

PoseEstimate Slam::estimate() const {
  PoseEstimate estimate = low_.estimate();
  if (has_segments()) {
    const Pose2 map_T_low = this->map_T_low();
    estimate = {map_T_low * estimate.map_T_scan, turned(estimate.covariance, map_T_low.yaw_rad)};
  }
  return estimate;
}

void Slam::write_occupancy(OccupancyMap& map) {
  if (has_segments()) {
    high_->write_occupancy(map);
  } else {
    low_.write_occupancy(map);
  }
}

bool Slam::write_square(GridCell corner, int side_cells, std::span<std::uint8_t> percent) {
  return has_segments() ? high_->write_square(corner, side_cells, percent)
                        : low_.write_square(corner, side_cells, percent);
}

AncestryGrid::View Slam::map_view() { return has_segments() ? high_->map() : low_.map(low_.best()); }

const GridGeometry& Slam::map_geometry() const {
  return has_segments() ? high_->particles().grid().geometry() : low_.geometry();
}

const GridGeometry& Slam::geometry() const { return high_ ? high_->particles().grid().geometry() : low_.geometry(); }

double Slam::pool_used() const {
  const double low = static_cast<double>(low_.tiles_used()) / params_.low.grid.tiles_max;
  const int high_tiles = high_ ? high_->particles().grid().tiles_used() : 0;
  return std::max(low, static_cast<double>(high_tiles) / params_.high.grid.tiles_max);
}

void Slam::write_path(std::vector<StampedPose>& path) const {
  low_.write_path(path);
  if (!has_segments()) {
    return;
  }
  const auto unfinished = static_cast<std::ptrdiff_t>(updates_unfinished_);
  const Pose2 map_T_low = this->map_T_low();
  std::vector<StampedPose> whole;
  high_->write_path(whole);
  for (auto pose = path.end() - unfinished; pose != path.end(); ++pose) {
    whole.push_back({.stamp_ns = pose->stamp_ns, .map_T_scan = map_T_low * pose->map_T_scan});
  }
  path.swap(whole);
}

int Slam::copy_last_poses(std::span<StampedPose> last) const {
  if (!has_segments()) {
    return low_.copy_last_poses(low_.best(), last);
  }
  const auto unfinished = static_cast<std::size_t>(updates_unfinished_);
  if (!high_->idle() || last.size() < unfinished) {
    return 0;
  }
  const int finished = high_->copy_last_poses(last.first(last.size() - unfinished));
  const std::span<StampedPose> rest = last.subspan(static_cast<std::size_t>(finished), unfinished);
  const int copied = low_.copy_last_poses(low_.best(), rest);
  const Pose2 map_T_low = this->map_T_low();
  for (StampedPose& pose : rest.first(static_cast<std::size_t>(copied))) {
    pose.map_T_scan = map_T_low * pose.map_T_scan;
  }
  return finished + copied;
}

/// Whatever HSLAM has not done of the segment before is done now: nothing is left if `work` was called as it should.
void Slam::close_segment() {
  run(high_->slices());
  RunSegment& segment = segments_[static_cast<std::size_t>(filling_)];
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

Pose2 Slam::map_T_low() const { return high_->best_pose() * low_T_finished().inverse(); }

Pose2 Slam::low_T_finished() const {
  const auto wanted = static_cast<std::size_t>(updates_unfinished_) + 1;
  static_cast<void>(low_.copy_last_poses(low_.best(), std::span(last_).first(wanted)));
  return last_[0].map_T_scan;
}

}  // namespace odoless
