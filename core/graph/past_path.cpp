#include "core/graph/past_path.hpp"

#include <algorithm>

namespace odoless {

void PastPath::add(const SubmapPlace& submap, bool is_joined) {
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
    submaps_[joined_].map_T_submap = new_T_map * submaps_[joined_].map_T_submap;
  }
}

}  // namespace odoless
