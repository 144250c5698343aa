// What a run leaves out of its world that newer visits have made needless (submap_graph.hpp).
#include <algorithm>
#include <utility>
#include <vector>

#include "core/graph/submap_graph.hpp"

namespace odoless {

bool SubmapGraph::is_to_thin() const {
  return !is_localising() && is_joined() && share_used() >= kCrowded_share && 10 * graph_.size() >= 11 * thinned_size_;
}

void SubmapGraph::thin() {
  if (thinning_->work(world())) {
    return;
  }
  const std::vector<int> needless = thinning_->needless();
  thinning_.reset();
  phase_ = Phase::kIdle;
  if (is_worth_leaving_out(needless.size(), submaps_.size())) {
    leave_out(needless);
  }
  thinned_size_ = graph_.size();
}

void SubmapGraph::leave_out(const std::vector<int>& needless) {
  const std::vector<Submap> submaps = submaps_;
  const std::vector<Pose2> poses(graph_.poses().begin(), graph_.poses().end());
  const int keyframes = store_.size();
  const SubmapNumbers numbers = odoless::leave_out(needless, store_, graph_, submaps_);
  const auto stays_before = [&](std::size_t end) {
    return std::ranges::count_if(numbers.now.begin(), numbers.now.begin() + static_cast<std::ptrdiff_t>(end),
                                 [](int now) { return now != SubmapNumbers::kNone; });
  };
  const auto by_heir = [&](const PlaceBySubmap& place) {
    const auto was = static_cast<std::size_t>(place.submap);
    const int heir = numbers.heir[was];
    return PlaceBySubmap{heir, graph_.pose(heir).inverse() * poses[was] * place.submap_T_scan};
  };
  past_.renumber(numbers, poses, graph_);
  for (const int each : needless) {
    if (static_cast<std::size_t>(each) >= run_begin_) {
      const PlaceBySubmap place = by_heir({each, {}});
      past_.add(submaps[static_cast<std::size_t>(each)], place.submap, place.submap_T_scan);
    }
  }
  first_submap_ = static_cast<std::size_t>(stays_before(first_submap_));
  run_begin_ = static_cast<std::size_t>(stays_before(run_begin_));
  revisited_ = static_cast<int>(stays_before(static_cast<std::size_t>(revisited_)));
  first_keyframe_ = first_submap_ < submaps_.size() ? submaps_[first_submap_].first_keyframe
                                                    : first_keyframe_ - (keyframes - store_.size());
  is_chained_ = is_chained_ && own_submaps() == 0;
  anchor_ = numbers.heir[static_cast<std::size_t>(anchor_)];
  expected_.reset();
  lost_at_ = lost_at_ ? std::optional(by_heir(*lost_at_)) : std::nullopt;
  if (filter_) {
    filter_->node = numbers.now[static_cast<std::size_t>(filter_->node)];
  }
  builder_.renumber(keyframes - store_.size());
  plan_.renumber(numbers.now);
  verifier_.renumber(numbers.now);
  matcher_.forget_from(0, params_.submaps_max);
  ++thinnings_;
  ++revision_;
}

}  // namespace odoless
