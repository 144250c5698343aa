#include "core/slam/path_pool.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace odoless {

PathPool::PathPool(int records_max, int particles_max, int appends_max)
    : particles_max_(static_cast<std::size_t>(particles_max)), appends_max_(static_cast<std::size_t>(appends_max)) {
  ODOLESS_CHECK(particles_max >= 1 && appends_max >= 1 && records_max >= 16 * appends_max * particles_max);
  records_.resize(static_cast<std::size_t>(records_max));
  free_.reserve(records_.size());
  ends_.resize(particles_max_);
  old_ends_.resize(particles_max_);
  reset();
}

void PathPool::reset() {
  std::fill(records_.begin(), records_.end(), Record{});
  free_.clear();
  for (auto i = static_cast<Index>(records_.size()); i-- > 0;) {
    free_.push_back(i);
  }
  particles_ = 1;
  ends_[0] = kNone;
  update_ = thinnings_ = thinned_ = 0;
}

void PathPool::retain(std::span<const int> copies) {
  ODOLESS_CHECK(copies.size() == particles_);
  for (std::size_t i = 0; i < particles_; ++i) {
    if (copies[i] == 0) {
      release(ends_[i]);
      ends_[i] = kNone;
    }
  }
}

void PathPool::branch(std::span<const int> copies) {
  ODOLESS_CHECK(copies.size() == particles_);
  old_ends_.swap(ends_);
  std::size_t count = 0;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    for (int copy = 0; copy < copies[i]; ++copy) {
      ends_[count++] = old_ends_[i];
    }
    if (copies[i] > 1 && old_ends_[i] != kNone) {
      records_[old_ends_[i]].users += static_cast<std::uint32_t>(copies[i] - 1);
    }
  }
  particles_ = count;
}

void PathPool::append(int particle, const StampedPose& pose) {
  ODOLESS_CHECK(!free_.empty());
  Index& end = ends_[static_cast<std::size_t>(particle)];
  const Index index = free_.back();
  free_.pop_back();
  records_[index] = {.pose = pose, .update = update_, .previous = end, .users = 1, .kept_in_thinning = 0};
  end = index;
}

void PathPool::next_update() {
  ++update_;
  if (free_.size() < appends_max_ * particles_max_) {
    thin();
  }
}

int PathPool::copy_last(int particle, std::span<StampedPose> last) const {
  std::size_t count = 0;
  for (Index i = ends_[static_cast<std::size_t>(particle)]; i != kNone && count < last.size();
       i = records_[i].previous) {
    last[count++] = records_[i].pose;
  }
  std::reverse(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(count));
  return static_cast<int>(count);
}

void PathPool::write_path(int particle, std::vector<StampedPose>& path) const {
  path.clear();
  for (Index i = ends_[static_cast<std::size_t>(particle)]; i != kNone; i = records_[i].previous) {
    path.push_back(records_[i].pose);
  }
  std::reverse(path.begin(), path.end());
}

std::size_t PathPool::memory_bytes() const {
  return records_.capacity() * sizeof(Record) +
         (free_.capacity() + ends_.capacity() + old_ends_.capacity()) * sizeof(Index);
}

void PathPool::release(Index index) {
  while (index != kNone && --records_[index].users == 0) {
    free_.push_back(index);
    index = records_[index].previous;
  }
}

/// A record goes unless it lost a neighbour in this round. So at least a third of those that may go does: of the older
/// half of the pool (7.5 times what an update appends) at most 2 per particle, forks and ends, may not.
void PathPool::thin() {
  ++thinnings_;
  const std::int64_t median = median_update();
  for (Record& record : records_) {
    const Index before = record.previous;
    if (record.users == 0 || before == kNone || !may_go(before, median)) {
      continue;
    }
    record.previous = records_[before].previous;
    record.kept_in_thinning = thinnings_;
    records_[record.previous].kept_in_thinning = thinnings_;
    records_[before].users = 0;
    free_.push_back(before);
    ++thinned_;
  }
  ODOLESS_CHECK(free_.size() >= appends_max_ * particles_max_);
}

/// The least update such that half of the records are not newer, by bisection: no memory, and 64 rounds at most.
std::int64_t PathPool::median_update() const {
  std::int64_t low = 0;
  std::int64_t high = update_;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    const auto older = std::count_if(records_.begin(), records_.end(), [middle](const Record& record) {
      return record.users > 0 && record.update <= middle;
    });
    if (2 * older >= records_used()) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

/// The very first record stays: a path begins where it began.
bool PathPool::may_go(Index index, std::int64_t newest_to_go) const {
  const Record& record = records_[index];
  return record.users == 1 && record.update <= newest_to_go && record.previous != kNone &&
         record.kept_in_thinning != thinnings_;
}

}  // namespace odoless
