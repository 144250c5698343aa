#pragma once

#include <vector>

#include "core/graph/seen_ground.hpp"
#include "core/graph/submap_world.hpp"

namespace odoless {

/// Where a world has room for less than a quarter more (share_of_pools), what is needless in it is left out, if that is
/// a tenth of it: what is left out is not known as well as before.
inline constexpr double kCrowded_share = 0.75;
[[nodiscard]] constexpr bool is_worth_leaving_out(std::size_t needless, std::size_t submaps) {
  return needless > 0 && 10 * needless >= submaps;
}

/// Which submaps of a world newer ones have made needless: a loop closure that holds ties it to a newer one, and of the
/// ground within 6 m of where it was seen from, newer ones that stay have seen 99 %, from as near. So what stands at a
/// place is what the last visits saw there, and a robot that goes the same ways day after day needs no more room than
/// the ways do.
///
/// The newest submap of each part always stays. Frames: map. Time: half a millisecond for each submap. Errors: none.
class WorldThinning {
 public:
  /// The same world is handed to each call.
  explicit WorldThinning(const SubmapWorld& world);
  /// Judges one submap, from the newest back. @return  Whether there is more.
  bool work(const SubmapWorld& world);
  /// Of those judged, by their numbers.
  [[nodiscard]] const std::vector<int>& needless() const { return needless_; }

 private:
  std::vector<bool> is_tied_;  ///< to a newer one
  int next_;
  SeenGround seen_;  ///< by those that stay
  std::vector<int> needless_;
};

/// All of them at once.
[[nodiscard]] std::vector<int> needless_submaps(const SubmapWorld& world);

/// What has become of the numbers of submaps.
struct SubmapNumbers {
  static constexpr int kNone = -1;

  explicit SubmapNumbers(std::size_t before) : now(before, kNone), heir(before, kNone) {}

  std::vector<int> now;   ///< of each that there was; kNone: it is no more
  std::vector<int> heir;  ///< the same, or of the one that has its constraints now
};

/// Takes submaps out of a world. What was known of them relative to others is handed over: the constraints of a submap
/// become those of the newer one that its surest loop closure ties it to, as all lie now, with covariances carried over
/// that closure; of two loop closures between the same submaps the surer one stays. So nothing moves, and no part falls
/// apart.
///
/// @param needless  Of needless_submaps. @param graph  Of which no node is held.
[[nodiscard]] SubmapNumbers leave_out(const std::vector<int>& needless, KeyframeStore& store, PoseGraph& graph,
                                      std::vector<Submap>& submaps);

}  // namespace odoless
