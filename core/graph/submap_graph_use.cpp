// What a run does with its world, and when it goes over to doing the other (submap_graph.hpp).
#include <algorithm>

#include "core/graph/submap_graph.hpp"

namespace odoless {

bool SubmapGraph::resume(const SubmapWorld& world, WorldUse use) {
  const int keyframes = world.store.size();
  const auto constraints = static_cast<int>(world.graph.constraints().size());
  if (keyframes > params_.keyframes_max || world.graph.size() > params_.submaps_max || !graph_.has_room(constraints) ||
      world.store.most_beams() > params_.keyframe_beams_max) {
    return false;
  }
  for (int k = 0; k < keyframes; ++k) {
    store_.add(world.store[k], world.store.codes(k), world.store.serial(k));
    store_.place(k, world.store.submap_T_scan(k));
  }
  for (int i = 0; i < world.graph.size(); ++i) {
    graph_.add_node(world.graph.pose(i));
  }
  for (const Constraint& each : world.graph.constraints()) {
    graph_.add(each);
  }
  submaps_.assign(world.submaps.begin(), world.submaps.end());
  plan_.add_submaps(submaps_.size());
  anchor_ = world.anchor;
  take_as_world(share_used() < 1.0 ? use : WorldUse::kLocalise);
  run_begin_ = first_submap_;
  searched_ = graph_.size();
  if (!submaps_.empty()) {
    localiser_.emplace(params_, scan_);
  }
  return true;
}

void SubmapGraph::take_as_world(WorldUse use) {
  world_used_ = share_used();
  use_ = use;
  first_submap_ = submaps_.size();
  first_keyframe_ = store_.size();
  graph_.hold(is_localising() ? graph_.size() : 0);
  revisited_ = static_cast<int>(first_submap_);
  anchor_keyframes_ = 0;
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    anchor_keyframes_ += map().has(static_cast<int>(i)) ? submaps_[i].keyframes : 0;
  }
  ++revision_;
}

// A path of which it is not known where it lies in the world is kept with it, and is not looked for there.
void SubmapGraph::go_over(WorldUse use) {
  if (use == use_) {
    return;
  }
  if (use == WorldUse::kContinue && is_in_world()) {
    use_ = use;
    graph_.hold(0);
    ++revision_;
    return;
  }
  if (use == WorldUse::kContinue) {
    begin_path_anew(true);
    return take_as_world(use);
  }
  const bool is_known = is_in_world();
  finish();
  if (submaps_.empty()) {
    return;
  }
  static_cast<void>(builder_.finish(store_));  // what found no room
  is_chained_ = own_submaps() > 0;
  take_as_world(use);
  unheld_ = 0;
  is_confirmed_ = is_known;
  filter_.reset();
  verifier_ = {};
  if (is_known && is_chained_) {
    searched_ = graph_.size();
    localiser_.reset();
  } else {
    begin_path_anew(true);
  }
}

double share_of_pools(const SubmapWorld& world, const GraphParams& params) {
  constexpr int kPath_submaps = 48;  // for which a world leaves room, or a quarter where a pool is small
  const auto share = [](std::size_t size, int most, int of_submap) {
    return static_cast<double>(size) / (most - std::min(kPath_submaps * of_submap, most / 4));
  };
  const auto keyframes = static_cast<std::size_t>(world.store.size());
  return std::max({share(world.submaps.size(), params.submaps_max, 1),
                   share(world.graph.constraints().size(), params.constraints_max, params.candidates + 1),
                   share(keyframes, params.keyframes_max, params.submap_keyframes)});
}

bool SubmapGraph::is_short_of_room() const {
  constexpr int kSubmaps = 2;  // one that has begun, and the next
  return graph_.size() + kSubmaps > params_.submaps_max || !graph_.has_room(kSubmaps * (params_.candidates + 1)) ||
         store_.size() + kSubmaps * params_.submap_keyframes > params_.keyframes_max;
}

}  // namespace odoless
