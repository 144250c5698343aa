#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/rng.hpp"
#include "core/graph/graph_params.hpp"
#include "core/graph/path_scan.hpp"
#include "core/graph/submap_world.hpp"
#include "core/match/match_reference.hpp"
#include "core/match/pose_search.hpp"

namespace odoless {

/// Where to look for a submap in another one's frame.
struct SubmapSearch {
  Pose2 centre{};
  double half_m = 0.0;
  double half_rad = 0.0;
};

/// How one submap lies to another one, and what speaks for it.
struct SubmapMatch {
  Pose2 reference_T_query{};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< pose_graph.hpp
  double score = 0.0;                                    ///< mean per point, 1 at most
  double agreement = 0.0;  ///< share of the points that the reference explains, of those that it knows anything of
  double coverage = 0.0;   ///< share of the points that the reference knows anything of
  bool is_weak = false;    ///< another place along the unconstrained direction may be right as well: covariance says so
  bool is_inside = false;  ///< of where was looked
};

/// Matches a submap against an older one with its neighbours, by the pose search that the odometry uses.
///
/// Memory is fixed at construction, but for scratch. Thread: owned by one thread. Not for real-time threads: a match
/// takes some 5 ms, up to 100 where it searches 7 m.
class SubmapMatcher {
 public:
  SubmapMatcher(const GraphParams& params, const ScanParams& scan);
  /// A copy has nothing ready, which changes no result.
  SubmapMatcher(const SubmapMatcher& other) : SubmapMatcher(other.params_, other.scan_) {}
  SubmapMatcher(SubmapMatcher&&) = default;
  SubmapMatcher& operator=(const SubmapMatcher& other) { return *this = SubmapMatcher(other); }
  SubmapMatcher& operator=(SubmapMatcher&&) = default;
  ~SubmapMatcher() = default;

  /// The submap that is searched for from here on, complete with its neighbourhood.
  void set_query(const SubmapWorld& world, int query);
  /// The same of a piece of a path, in whose frame the match then is.
  void set_query(const KeyframeStore& store, std::span<const PathScan> piece);
  [[nodiscard]] SubmapMatch match(const SubmapWorld& world, int reference, const SubmapSearch& where, Rng& rng);
  /// A submap's neighbourhood has changed.
  void forget(int reference) { forget_from(reference, reference + 1); }
  /// Those submaps have, or are others now.
  void forget_from(int first, int end);

 private:
  struct Ready {
    std::unique_ptr<MatchReference> reference;
    int submap = -1;
    std::int64_t used = 0;
  };

  [[nodiscard]] MatchReference& reference_of(const SubmapWorld& world, int submap);
  void place(const SubmapWorld& world, int reference, int submap);
  /// Peaks along the unconstrained direction of the best one, found by climbs from a few places.
  void probe(const SearchGround& ground, const SubmapSearch& where, Point2 direction, Peaks& peaks) const;
  void judge(const ScoreRaster& raster, SubmapMatch& match) const;

  GraphParams params_;
  ScanParams scan_;
  std::vector<Ready> ready_;
  std::int64_t uses_ = 0;
  std::vector<ScanFrame> frames_;
  std::vector<PlacedScan> placed_;
  std::vector<PathScan> piece_;
  SearchedScan query_;
  int query_submap_ = -1;
  PoseSearch search_;
};

}  // namespace odoless
