#include "core/graph/past_path.hpp"

#include <algorithm>

namespace odoless {

void PastPath::append(const Past& submap, bool is_joined) {
  if (submaps_.size() == kSubmaps_max) {
    constexpr std::size_t kHalf = kSubmaps_max / 2;
    submaps_.erase(submaps_.begin(), submaps_.begin() + kHalf);
    joined_ -= std::min(joined_, kHalf);
  }
  submaps_.push_back(submap);
  joined_ = is_joined ? submaps_.size() : joined_;
}

void PastPath::join(const Pose2& new_T_map) {
  for (; joined_ < submaps_.size(); ++joined_) {
    Pose2& map_T_submap = submaps_[joined_].place.map_T_submap;
    map_T_submap = new_T_map * map_T_submap;
  }
}

void PastPath::renumber(const SubmapNumbers& numbers, const std::vector<Pose2>& before, const PoseGraph& graph) {
  for (Past& each : submaps_) {
    if (each.by != SubmapNumbers::kNone) {
      const auto by = static_cast<std::size_t>(each.by);
      each.by = numbers.heir[by];
      Pose2& by_T_submap = each.place.map_T_submap;
      by_T_submap = numbers.now[by] == each.by ? by_T_submap : graph.pose(each.by).inverse() * before[by] * by_T_submap;
    }
  }
}

std::vector<SubmapPlace> PastPath::submaps(const PoseGraph& graph) const {
  std::vector<SubmapPlace> places;
  for (const Past& each : submaps_) {
    places.push_back(each.place);
    if (each.by != SubmapNumbers::kNone) {
      places.back().map_T_submap = graph.pose(each.by) * each.place.map_T_submap;
    }
  }
  return places;
}

}  // namespace odoless
