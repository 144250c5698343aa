#include "tools/replay/mapper.hpp"

#include "core/base/check.hpp"
#include "core/graph/world_map.hpp"

namespace odoless {

Mapper::Mapper(const RobotParams& params, std::uint64_t seed)
    : params_(params), chain_(std::in_place, params, seed, false) {
  if (params.graph.enabled) {
    graph_.emplace(params, seed);
  }
}

ChainStep Mapper::process(const RawScan& raw, bool is_level) {
  ChainStep step = chain_->process(raw, raw.stamp_ns, is_level);
  if (step.verdict != ScanVerdict::kAccepted) {
    return step;
  }
  filter_updates_ += step.filter.updated ? 1 : 0;
  if (graph_) {
    graph_->add(chain_->frame(), step.motion, step.filter);
    odom_.push_back({step.stamp_ns, step.motion.odom_T_current});
  } else {
    update_T_scan_.push_back(step.filter.update_T_scan);
    updates_.push_back(filter_updates_ - 1);
  }
  online_.push_back({step.stamp_ns, step.filter.map_T_scan});
  return step;
}

void Mapper::finish() {
  chain_->filter().filter().finish();
  if (graph_) {
    graph_->finish();
  }
}

void Mapper::release_stages() {
  ODOLESS_CHECK(graph_);
  chain_.reset();
}

std::vector<StampedPose> Mapper::trajectory() { return graph_ ? graph()->corrected(odom_) : trajectory_of_filter(); }

// Each scan hangs on the filter update before it; the best particle's path says where that update was.
std::vector<StampedPose> Mapper::trajectory_of_filter() {
  std::vector<StampedPose> path;
  chain_->filter().filter().write_path(path);
  std::vector<StampedPose> out = online_;
  if (static_cast<int>(path.size()) != filter_updates_) {
    return out;  // thinned paths: the poses of the time stand
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].map_T_scan = path[static_cast<std::size_t>(updates_[i])].map_T_scan * update_T_scan_[i];
  }
  return out;
}

OccupancyMap Mapper::map() {
  const LslamParams& low = params_.slam.low;
  if (graph_) {
    return render_world(graph()->map(), low.beam, params_.scan, low.grid.resolution_m);
  }
  OccupancyMap out;
  chain_->filter().filter().write_occupancy(out);
  return out;
}

}  // namespace odoless
