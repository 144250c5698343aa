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
/// When less than an eighth of the pool is free, paths are thinned: of the older half of the records, every second one
/// along each path goes, but for the first and those where paths fork. What goes is counted.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction but in `write_path`. Every update is linear in what it may append,
///            however large the pool is: thinning, and giving back what lost particles alone led to, are spread over
///            updates, and look at 16 records for each that an update may append.
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

  /// With those that are to be given back still.
  [[nodiscard]] int records_used() const { return static_cast<int>(records_.size() - room()); }
  [[nodiscard]] std::int64_t thinned() const { return thinned_; }

 private:
  using Index = std::uint32_t;
  static constexpr Index kNone = UINT32_MAX;

  struct Record {
    StampedPose pose;
    Index previous = kNone;
    std::uint32_t users = 0;  ///< records and ends of paths that point here
    Index older = kNone;      ///< next in the order in which records were appended, to either side
    Index newer = kNone;      ///< of a lost one: the next lost one
    std::uint32_t kept_in_thinning = 0;
  };

  /// Records that are free.
  [[nodiscard]] std::size_t room() const { return free_.size() + records_.size() - fresh_; }
  [[nodiscard]] Index take();
  /// Takes one user from a record, which is lost with its last.
  void leave(Index index);
  /// Takes a record out of the order of age.
  void unlink(Index index);
  void give_back_lost();
  void thin();
  [[nodiscard]] bool may_go(Index index) const;

  std::size_t particles_max_;
  std::size_t appends_max_;
  std::size_t particles_ = 1;
  std::vector<Record> records_;
  std::size_t fresh_ = 0;    ///< from here on records were never used
  std::vector<Index> free_;  ///< of those before
  Index oldest_ = kNone;
  Index newest_ = kNone;
  Index lost_ = kNone;       ///< no path leads over it; a list
  std::vector<Index> ends_;  ///< by particle
  std::vector<Index> old_ends_;
  std::uint32_t thinnings_ = 0;
  Index to_thin_ = kNone;       ///< next record that a thinning looks at
  std::size_t thin_ahead_ = 0;  ///< records that it looks at still
  std::int64_t thinned_ = 0;
};

}  // namespace odoless
