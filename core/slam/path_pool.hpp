#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/stamped_pose.hpp"

namespace odoless {

/// The whole path of every particle, in a fixed pool: records point to the one before, so that particles share what
/// they have in common, and a record goes when no path leads over it.
///
/// When the pool has no room for what an update may append to every path, paths are thinned: of the older half of the
/// records, every second one along each path goes, but for the first and those where paths fork. What goes is counted.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction but in `write_path`; thinning is linear in the pool, all else in the
///            particles (the records that a lost particle alone led to are given back in one go).
class PathPool {
 public:
  /// @param records_max  At least 16 * appends_max * particles_max: thinning then always finds room.
  /// @param appends_max  Most that a path grows by between two calls of `next_update`.
  PathPool(int records_max, int particles_max, int appends_max = 1);

  /// One particle, without a path.
  void reset();
  /// The two halves of a resampling, as in AncestryTree.
  void retain(std::span<const int> copies);
  void branch(std::span<const int> copies);
  /// Lengthens a particle's path. All appended between two calls of `next_update` belong to the same update.
  void append(int particle, const StampedPose& pose);
  /// Begins an update; makes room for it.
  void next_update();

  /// The last poses of a particle's path, oldest first, as many as the path has, up to the span's size. Returns their
  /// number. Whole unless paths were thinned down to them.
  [[nodiscard]] int copy_last(int particle, std::span<StampedPose> last) const;

  /// A particle's path from its first pose to its last. May allocate, in `path` alone.
  void write_path(int particle, std::vector<StampedPose>& path) const;

  [[nodiscard]] int records_used() const { return static_cast<int>(records_.size() - free_.size()); }
  [[nodiscard]] std::int64_t thinned() const { return thinned_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  using Index = std::uint32_t;
  static constexpr Index kNone = UINT32_MAX;

  struct Record {
    StampedPose pose;
    std::int64_t update = 0;
    Index previous = kNone;
    std::uint32_t users = 0;  ///< records and ends of paths that point here; 0: free
    std::int64_t kept_in_thinning = 0;
  };

  void release(Index index);
  void thin();
  [[nodiscard]] std::int64_t median_update() const;
  [[nodiscard]] bool may_go(Index index, std::int64_t newest_to_go) const;

  std::size_t particles_max_;
  std::size_t appends_max_;
  std::size_t particles_ = 1;
  std::vector<Record> records_;
  std::vector<Index> free_;
  std::vector<Index> ends_;  ///< by particle
  std::vector<Index> old_ends_;
  std::int64_t update_ = 0;
  std::int64_t thinnings_ = 0;
  std::int64_t thinned_ = 0;
};

}  // namespace odoless
