// What a run in a world that stays as it is forgets of its own path (submap_graph.hpp).
#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "core/graph/submap_graph.hpp"

namespace odoless {

void SubmapGraph::begin_path_anew(bool is_near) {
  while (work()) {
  }
  if (has_path() && is_near) {
    const Keyframe& last = store_[store_.size() - 1];
    lost_map_T_odom_ = map_T_odom();
    map_T_local_ = lost_map_T_odom_ * last.map_T_odom.inverse();
    if (is_joined()) {
      lost_at_ = {anchor_, graph_.pose(anchor_).inverse() * lost_map_T_odom_ * last.odom_T_scan};
    }
  } else if (!is_near) {
    lost_at_.reset();
    map_T_local_ = lost_map_T_odom_ = {};
  }
  for (std::size_t i = first_submap_; i < submaps_.size(); ++i) {
    past_.add({submaps_[i].odom_T_submap, graph_.pose(static_cast<int>(i)), submaps_[i].origin_stamp_ns}, is_joined());
  }
  past_.lose();
  static_cast<void>(builder_.finish(store_));
  erase_own(own_submaps(), store_.size() - first_keyframe_);
  localiser_.emplace(params_, scan_);
  expected_ = is_near && !lost_at_ ? expected_ : lost_at_;
  unheld_ = 0;
}

void SubmapGraph::keep_path(const Keyframe& next) {
  if (next.since_last.is_torn() || (is_joined() && unheld_ >= kOwn_submaps)) {
    begin_path_anew(true);
  } else if (is_joined() && is_contradicted()) {
    begin_path_anew(false);
  } else if (own_submaps() > 1 && is_short_of_room()) {
    while (work()) {
    }
    forget_oldest();
  } else if (own_submaps() > kOwn_submaps && !has_work()) {
    forget_oldest();
  }
}

// The world knows the place of all of these, where they are taken to lie, and none is like it.
bool SubmapGraph::is_contradicted() const {
  const auto world = graph_.poses().first(first_submap_);
  int known = 0;
  for (int i = graph_.size() - unheld_; i < graph_.size() - 1; ++i) {
    known += std::ranges::any_of(world, [&](const Pose2& each) { return each.distance_m(graph_.pose(i)) < kKnown_m; })
                 ? 1
                 : 0;
  }
  return known >= kUnlike_submaps;
}

void SubmapGraph::note_closures() {
  const auto first = static_cast<int>(first_submap_);
  std::set<int> held;
  for (const Constraint& each : graph_.constraints()) {
    if (each.is_loop && each.holds() && each.from < first && each.to >= first) {
      held.insert(each.to);
    }
  }
  unheld_ = graph_.size() - 1 - (held.empty() ? first - 1 : *held.rbegin());
  is_confirmed_ = is_confirmed_ || held.size() >= kConfirmed_submaps;
}

void SubmapGraph::forget_oldest() {
  const Submap& oldest = submaps_[first_submap_];
  const std::optional<Constraint> hold = hold_of_second();
  past_.add({oldest.odom_T_submap, graph_.pose(static_cast<int>(first_submap_)), oldest.origin_stamp_ns}, is_joined());
  const int keyframes = oldest.keyframes;
  erase_own(1, keyframes);
  builder_.renumber(keyframes);
  if (localiser_) {
    localiser_->renumber(first_keyframe_, keyframes);
  }
  if (hold && graph_.has_room(2)) {
    graph_.add(*hold);
  }
}

// As it lies now, as sure as the surest of what holds the first one in the world and the odometry between them.
std::optional<Constraint> SubmapGraph::hold_of_second() const {
  const auto first = static_cast<int>(first_submap_);
  const Constraint* surest = nullptr;
  const Constraint* step = nullptr;
  for (const Constraint& each : graph_.constraints()) {
    if (each.to == first && each.from < first && each.holds() &&
        (surest == nullptr || each.covariance.trace() < surest->covariance.trace())) {
      surest = &each;
    } else if (!each.is_loop && each.from == first && each.to == first + 1) {
      step = &each;
    }
  }
  if (surest == nullptr || step == nullptr) {
    return std::nullopt;
  }
  return Constraint{.from = surest->from,
                    .to = first,
                    .from_T_to = graph_.between(surest->from, first + 1),
                    .covariance = carried(surest->covariance, step->from_T_to) + step->covariance,
                    .is_loop = true};
}

void SubmapGraph::erase_own(int submaps, int keyframes) {
  const auto first = static_cast<int>(first_submap_);
  std::vector<int> now(submaps_.size());
  std::iota(now.begin(), now.begin() + first, 0);
  std::fill_n(now.begin() + first, submaps, SubmapNumbers::kNone);
  std::iota(now.begin() + first + submaps, now.end(), first);
  std::vector<bool> is_gone(static_cast<std::size_t>(store_.size()), false);
  std::fill_n(is_gone.begin() + first_keyframe_, keyframes, true);
  submaps_.erase(submaps_.begin() + first, submaps_.begin() + first + submaps);
  for (std::size_t i = first_submap_; i < submaps_.size(); ++i) {
    submaps_[i].first_keyframe -= keyframes;
  }
  store_.erase(is_gone);
  graph_.erase(first, submaps);
  plan_.renumber(now);
  verifier_.renumber(now);
  matcher_.forget_from(first, params_.submaps_max);
  revisited_ = first;
  filter_.reset();
  is_chained_ = false;
  forgotten_ += submaps;
  ++revision_;
}

}  // namespace odoless
