#include "core/cloud/voxel_table.hpp"

#include <algorithm>
#include <bit>

#include "core/base/check.hpp"

namespace odoless {
namespace {

bool is_in_reach(std::int32_t index) {
  return index >= -VoxelTable::kReach_voxels && index < VoxelTable::kReach_voxels;
}

std::uint64_t field(std::int32_t index) { return static_cast<std::uint64_t>(index + VoxelTable::kReach_voxels); }

// 21 bits each; nothing out of reach.
std::optional<std::uint64_t> key_of(const Voxel& voxel) {
  constexpr unsigned kBits = 21;
  if (!is_in_reach(voxel.x) || !is_in_reach(voxel.y) || !is_in_reach(voxel.z)) {
    return std::nullopt;
  }
  return (field(voxel.x) << (2 * kBits)) | (field(voxel.y) << kBits) | field(voxel.z);
}

// The finaliser of splitmix64: neighbours in space are spread over the whole table.
std::uint64_t scattered(std::uint64_t key) {
  key = (key ^ (key >> 30U)) * 0xbf58476d1ce4e5b9U;
  key = (key ^ (key >> 27U)) * 0x94d049bb133111ebU;
  return key ^ (key >> 31U);
}

}  // namespace

VoxelTable::VoxelTable(int voxels_max) : entries_(std::bit_ceil(2 * static_cast<std::size_t>(voxels_max))) {
  ODOLESS_CHECK(voxels_max > 0);
}

std::optional<std::size_t> VoxelTable::place_of(std::uint64_t key) const {
  std::size_t at = scattered(key) & (entries_.size() - 1);
  for (int probe = 0; probe < kProbesMax; ++probe, at = (at + 1) & (entries_.size() - 1)) {
    if (entries_[at].generation != generation_ || entries_[at].key == key) {
      return at;
    }
  }
  return std::nullopt;
}

std::optional<std::uint32_t> VoxelTable::find_or_add(const Voxel& voxel, std::uint32_t number) {
  const std::optional<std::uint64_t> key = key_of(voxel);
  const std::optional<std::size_t> at = key ? place_of(*key) : std::nullopt;
  if (!at) {
    return std::nullopt;
  }
  Entry& entry = entries_[*at];
  if (entry.generation != generation_) {
    entry = {*key, generation_, number};
    ++size_;
  }
  return entry.number;
}

std::optional<std::uint32_t> VoxelTable::find(const Voxel& voxel) const {
  const std::optional<std::uint64_t> key = key_of(voxel);
  const std::optional<std::size_t> at = key ? place_of(*key) : std::nullopt;
  return at && entries_[*at].generation == generation_ ? std::optional(entries_[*at].number) : std::nullopt;
}

void VoxelTable::clear() {
  size_ = 0;
  if (++generation_ == 0) {  // after 2^32 times old entries would look new
    std::fill(entries_.begin(), entries_.end(), Entry{});
    generation_ = 1;
  }
}

}  // namespace odoless
