#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace odoless {

/// A cube of space, counted in voxels from a frame's origin.
struct Voxel {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
};

/// Which number each voxel has: a hash table of fixed size with linear probing.
///
/// Full is a table where a voxel finds no free place within kProbesMax steps: it is refused then, and what is there
/// stays. That happens nowhere near half full, and certainly at 100 %.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; at most kProbesMax steps per call; `clear` takes one.
class VoxelTable {
 public:
  static constexpr int kProbesMax = 64;
  static constexpr std::int32_t kReach_voxels = 1 << 20;  ///< voxels are in -kReach_voxels .. kReach_voxels - 1

  /// @param voxels_max  Room for twice as many is set aside, rounded up to a power of two.
  explicit VoxelTable(int voxels_max);

  /// The voxel's number; `number` is made it where it had none. Nothing where the table is full or the voxel out of
  /// reach.
  [[nodiscard]] std::optional<std::uint32_t> find_or_add(const Voxel& voxel, std::uint32_t number);
  /// The voxel's number, if it has one.
  [[nodiscard]] std::optional<std::uint32_t> find(const Voxel& voxel) const;

  void clear();
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t generation = 0;  ///< another one than the table's: free
    std::uint32_t number = 0;
  };

  /// Where the voxel's entry is or would be; nothing after kProbesMax steps, or out of reach.
  [[nodiscard]] std::optional<std::size_t> place_of(std::uint64_t key) const;

  std::vector<Entry> entries_;
  std::uint32_t generation_ = 1;
  std::size_t size_ = 0;
};

}  // namespace odoless
