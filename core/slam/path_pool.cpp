#include "core/slam/path_pool.hpp"

#include <algorithm>
#include <utility>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr std::size_t kLooks = 16;  // per record that an update may append

}  // namespace

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
  fresh_ = 0;
  free_.clear();
  particles_ = 1;
  ends_[0] = oldest_ = newest_ = lost_ = to_thin_ = kNone;
  thinnings_ = 0;
  thin_ahead_ = 0;
  thinned_ = 0;
}

void PathPool::retain(std::span<const int> copies) {
  ODOLESS_CHECK(copies.size() == particles_);
  for (std::size_t i = 0; i < particles_; ++i) {
    if (copies[i] == 0) {
      leave(ends_[i]);
      ends_[i] = kNone;
    }
  }
  give_back_lost();
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
  Index& end = ends_[static_cast<std::size_t>(particle)];
  const Index index = take();
  records_[index] = {
      .pose = pose, .previous = end, .users = 1, .older = newest_, .newer = kNone, .kept_in_thinning = 0};
  (newest_ == kNone ? oldest_ : records_[newest_].newer) = index;
  newest_ = end = index;
}

/// An eighth of the pool is twice what an update may append, or more, and a thinning of the older half is done before
/// half of that eighth is appended. At least a third of the records that may go does: all of that half but for 2 per
/// particle, forks and ends. While lost records wait, an update gives back more of them than it may append.
void PathPool::next_update() {
  give_back_lost();
  if (lost_ == kNone && to_thin_ == kNone && room() < records_.size() / 8) {
    ++thinnings_;
    to_thin_ = oldest_;
    thin_ahead_ = static_cast<std::size_t>(records_used()) / 2;
  }
  thin();
  ODOLESS_CHECK(room() >= appends_max_ * particles_max_);
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

PathPool::Index PathPool::take() {
  if (free_.empty()) {
    ODOLESS_CHECK(fresh_ < records_.size());
    return static_cast<Index>(fresh_++);
  }
  const Index index = free_.back();
  free_.pop_back();
  return index;
}

void PathPool::leave(Index index) {
  if (index != kNone && --records_[index].users == 0) {
    unlink(index);
    records_[index].newer = lost_;
    lost_ = index;
  }
}

void PathPool::unlink(Index index) {
  const auto [older, newer] = std::pair(records_[index].older, records_[index].newer);
  (older == kNone ? oldest_ : records_[older].newer) = newer;
  (newer == kNone ? newest_ : records_[newer].older) = older;
  to_thin_ = to_thin_ == index ? newer : to_thin_;
}

void PathPool::give_back_lost() {
  for (std::size_t i = 0; i < kLooks * appends_max_ * particles_max_ && lost_ != kNone; ++i) {
    const Index index = lost_;
    lost_ = records_[index].newer;
    free_.push_back(index);
    leave(records_[index].previous);
  }
}

/// A record goes unless it lost a neighbour in this round.
void PathPool::thin() {
  for (std::size_t i = 0; i < kLooks * appends_max_ * particles_max_ && to_thin_ != kNone; ++i) {
    const Index index = to_thin_;
    to_thin_ = --thin_ahead_ > 0 ? records_[index].newer : kNone;
    const Index before = records_[index].previous;
    if (before == kNone || !may_go(before)) {
      continue;
    }
    records_[index].previous = records_[before].previous;
    records_[index].kept_in_thinning = records_[records_[before].previous].kept_in_thinning = thinnings_;
    unlink(before);
    free_.push_back(before);
    ++thinned_;
  }
}

/// The very first record stays: a path begins where it began.
bool PathPool::may_go(Index index) const {
  const Record& record = records_[index];
  return record.users == 1 && record.previous != kNone && record.kept_in_thinning != thinnings_;
}

}  // namespace odoless
