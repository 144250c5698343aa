#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "core/graph/graph_params.hpp"
#include "core/graph/graph_solver.hpp"
#include "core/graph/keyframe_store.hpp"
#include "core/graph/localiser.hpp"
#include "core/graph/loop_verifier.hpp"
#include "core/graph/map_correction.hpp"
#include "core/graph/match_plan.hpp"
#include "core/graph/past_path.hpp"
#include "core/graph/pose_graph.hpp"
#include "core/graph/submap_builder.hpp"
#include "core/graph/submap_matcher.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "core/graph/world_thinning.hpp"

namespace odoless {

/// Share of the fullest pool that a world has, of what is not left for a path in it: submaps, constraints, keyframes.
/// From 1 on it is full.
[[nodiscard]] double share_of_pools(const SubmapWorld& world, const GraphParams& params);

/// What a run does with its world: it grows and is corrected, or it stays as it is.
enum class WorldUse : std::uint8_t { kContinue, kLocalise };

/// The world as a pose graph of submaps, from laser odometry alone: closes loops of any size, and says where the odom
/// frame lies in the map frame. How: core/graph/README.md.
///
/// When a submap ends, the one before it, whose neighbours are then complete, is matched with older ones that may
/// overlap it by what the odometry may have drifted. A match is taken at once where it cannot be another place, else
/// when others agree with it. After every submap the graph is solved, with the newest one drawn to where the particle
/// filter has it.
///
/// A run may continue a world that others have made: then its own submaps are a component apart, until a Localiser has
/// found where they lie; from then on they are submaps like all others. Or it may only find its way in that world,
/// which then stays as it is: of its own submaps it keeps the newest ones alone, and where it may have been carried, by
/// a motion that is not credible, its path begins anew and is looked for, first where it was lost.
///
/// Where little room is left, it leaves out what newer visits have made needless (WorldThinning). It may go over from
/// one use to the other at any time, and does so by itself where the world is full nevertheless: from then on all that
/// was mapped stays as it is, and what room is left is for the path.
///
/// Frames: map, which is where the first keyframe has it (REP 105). odom never jumps; map_T_odom does, at a correction.
/// Thread: owned by one thread. Not for real-time threads. The same scans, motions and random seed give the same bytes.
class SubmapGraph {
 public:
  /// What has come of the matches.
  struct Counts {
    std::int64_t tried = 0;
    std::int64_t credible = 0;
    std::int64_t accepted = 0;
    std::int64_t taken_out = 0;  ///< accepted, then contradicted by the rest of the graph
    std::int64_t refused = 0;    ///< for want of room
    double solve_chi2 = 0.0;
  };

  SubmapGraph(const GraphParams& params, const RobotLimits& limits, const ScanParams& scan, std::uint64_t seed);

  /// Before the first keyframe: continues a world, which is copied. @return  Whether there is room for it: submaps,
  /// constraints, keyframes, and beams of each. A world that is full stays as it is.
  [[nodiscard]] bool resume(const SubmapWorld& world, WorldUse use = WorldUse::kContinue);
  [[nodiscard]] bool is_localising() const { return use_ == WorldUse::kLocalise; }
  /// To localise: does all work, and all that was mapped so far is the world; the path goes on where it is. Without a
  /// submap it is nothing. To continue: what is kept of the path is the world's from now on; where it is not sure it
  /// begins anew, expected where it is, and joins the world as any run does.
  void go_over(WorldUse use);
  /// While it is not known where the path lies in that world, or always where it stays as it is: where the robot may be
  /// by now, or was last.
  void expect(const Pose2& map_T_scan) {
    if (is_localising()) {
      begin_path_anew(true);
    }
    if (!is_in_world()) {
      expected_ = {anchor_, graph_.pose(anchor_).inverse() * map_T_scan};
    }
  }
  void expect(const PlaceBySubmap& place) { expected_ = place; }
  /// Whether this run's submaps are joined to those of before, if there are any.
  [[nodiscard]] bool is_joined() const { return !localiser_; }
  /// The path is another one from here on, where the world stays as it is: the robot is looked for.
  /// @param is_near  First where it is now.
  void begin_path_anew(bool is_near);
  /// Whether where the robot is in the world is a guess, by scans or from where it was.
  [[nodiscard]] bool is_guessed() const { return !is_in_world() && (is_joined() || lost_at_ || localiser_->guess()); }
  /// Whether the map is of where the robot is: they are joined, or this run's own are the largest part of the world.
  /// In a world that stays as it is, loop closures must speak for it, too, and not be long ago.
  [[nodiscard]] bool is_in_world() const {
    return is_localising() ? is_joined() && is_confirmed_ && unheld_ < kUnheld_submaps
                           : is_joined() || anchor_ >= static_cast<int>(first_submap_);
  }
  /// Until then, map_T_odom that the last metres speak for, if they do.
  [[nodiscard]] std::optional<Pose2> guess() const {
    return is_in_world() || is_joined() ? std::nullopt : localiser_->guess();
  }

  /// Every keyframe. @return  Whether there is work.
  bool add(const Keyframe& keyframe, std::span<const BeamCode> codes);
  /// One step of the work: a match, a verification or a solution. @return  Whether there is more.
  bool work();
  /// Ends the submap that has begun and does all work: when a run is over.
  void finish();

  /// From the newest submap on; behind a motion that is not credible as the particle filter had it over that.
  [[nodiscard]] Pose2 map_T_odom() const;
  /// What the local map may have slipped by since the newest submap, over (x_m, y_m) in the axes of odom.
  [[nodiscard]] const Eigen::Matrix2d& odom_slip() const { return odom_slip_; }
  /// Whether anything says where odom lies.
  [[nodiscard]] bool has_path() const { return is_chained_ || store_.size() > first_keyframe_; }
  [[nodiscard]] bool is_behind_unknown_motion() const { return builder_.is_behind_unknown_motion(); }
  /// The oldest of the corrections by loop closures that nobody has taken yet; of more than 8 the newest ones.
  [[nodiscard]] std::optional<MapCorrection> take_correction();
  /// Grows when submaps are new or have moved.
  [[nodiscard]] std::int64_t revision() const { return revision_; }
  [[nodiscard]] std::span<const Submap> submaps() const { return submaps_; }
  /// A submap that the map is of: where the robot was found, else of the part with the most keyframes.
  [[nodiscard]] int anchor() const { return anchor_; }
  /// The first submap and keyframe of the path: of this run, or since it has gone over.
  [[nodiscard]] std::size_t first_submap() const { return first_submap_; }
  [[nodiscard]] int first_keyframe() const { return first_keyframe_; }
  /// Keyframes that are the world's, or will be.
  [[nodiscard]] int mapped_keyframes() const { return is_localising() ? first_keyframe_ : store_.size(); }
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  [[nodiscard]] const KeyframeStore& keyframes() const { return store_; }
  /// Own submaps of the path that are no more.
  [[nodiscard]] int forgotten() const { return forgotten_; }
  /// Grows when submaps are left out that newer ones have made needless: others have lower numbers then.
  [[nodiscard]] int thinnings() const { return thinnings_; }
  /// What the map is drawn of.
  [[nodiscard]] SubmapWorld map() const {
    return is_localising() ? SubmapWorld{store_, graph_, std::span(submaps_).first(first_submap_), {}, anchor_}
                           : world();
  }
  [[nodiscard]] SubmapWorld world() const {
    return {store_, graph_, submaps_, is_in_world() ? std::optional(map_T_odom()) : std::nullopt, anchor_};
  }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// share_of_pools, 1 at most.
  [[nodiscard]] double used() const { return is_localising() ? world_used_ : share_used(); }
  [[nodiscard]] bool is_full() const { return used() >= 1.0; }
  /// Where each of these poses was, as known now: between two submaps' origins a correction goes in with the travel.
  /// @param odom  odom_T_scan of all scans in their order, keyframes and others; some may lack.
  [[nodiscard]] std::vector<StampedPose> corrected(std::span<const StampedPose> odom) const;
  /// The same, piece by piece.
  [[nodiscard]] TrajectoryCorrection correction() const;

 private:
  enum class Phase : std::uint8_t { kIdle, kMatch, kVerify, kSolve, kThin };
  // In a world that stays as it is, own submaps
  static constexpr int kOwn_submaps = 40;    ///< that are kept: 200 m
  static constexpr int kUnheld_submaps = 5;  ///< without a loop closure, from which on it is not sure
  static constexpr int kUnlike_submaps = 6;  ///< of these, where the world has a submap within kKnown_m
  static constexpr double kKnown_m = 3.0;
  static constexpr std::size_t kConfirmed_submaps = 2;  ///< with loop closures, that confirm where the path was found
  static constexpr std::size_t kCorrections_max = 8;

  [[nodiscard]] bool has_work() const { return phase_ != Phase::kIdle || (localiser_ && localiser_->has_work()); }
  [[nodiscard]] int own_submaps() const { return static_cast<int>(submaps_.size() - first_submap_); }
  /// The path's first submap, or the world's last one where it goes on from that.
  [[nodiscard]] std::size_t path_begin() const { return first_submap_ - (is_chained_ ? 1U : 0U); }
  /// All that there is now is the world.
  void take_as_world(WorldUse use);
  [[nodiscard]] double share_used() const { return std::min(share_of_pools(world(), params_), 1.0); }
  /// Whether there is hardly room for the next submap of a path.
  [[nodiscard]] bool is_short_of_room() const;
  void localise();
  /// Joins this run's submaps to the world by this match of its path.
  void join(const PieceMatch& match);
  /// The submap of this run that a keyframe belongs to; none: it was not taken.
  [[nodiscard]] std::optional<int> submap_of(int keyframe) const;
  [[nodiscard]] bool has_room_for_submap() const { return !graph_.full() && graph_.has_room(1); }
  /// Does all work, which may have the path joined to the world, before it ends the submap that has begun, if there is
  /// one.
  void end_submap();
  void add_submap();
  /// Before a keyframe, in a world that stays as it is.
  void keep_path(const Keyframe& next);
  void forget_oldest();
  /// Whether the robot must be elsewhere.
  [[nodiscard]] bool is_contradicted() const;
  /// By which of the newest submaps loop closures hold the path in the world.
  void note_closures();
  /// What the world says of the second own submap through the first one.
  [[nodiscard]] std::optional<Constraint> hold_of_second() const;
  void erase_own(int submaps, int keyframes);
  /// Whether little room is left, and a tenth of the submaps has come since that was looked at.
  [[nodiscard]] bool is_to_thin() const;
  void thin();
  void leave_out(const std::vector<int>& needless);
  /// Plans the matches of a submap, and of a few older ones.
  void begin_work(int query);
  void try_next();
  void accept(const LoopCandidate& candidate, bool is_new);
  /// That it holds, for the next correction.
  void note_closure(int reference, int query);
  void verify();
  void solve();
  /// Where the map has the newest keyframe.
  [[nodiscard]] Pose2 map_T_newest() const;
  /// What the loop closures since the last correction have done to it.
  void note_correction(CorrectionCause cause, const Pose2& map_T_newest_before);

  GraphParams params_;
  ScanParams scan_;
  RobotLimits limits_;
  Rng rng_;
  KeyframeStore store_;
  SubmapBuilder builder_;
  Eigen::Matrix2d odom_slip_ = Eigen::Matrix2d::Zero();
  std::vector<Submap> submaps_;
  PoseGraph graph_;
  SubmapMatcher matcher_;
  LoopVerifier verifier_;
  std::optional<Localiser> localiser_;  ///< while it is not known where this run lies in the world
  std::size_t first_submap_ = 0;
  int first_keyframe_ = 0;
  std::size_t run_begin_ = 0;              ///< first submap of this run
  int searched_ = 0;                       ///< submaps in which the path is looked for
  bool is_chained_ = false;                ///< odometry leads from the world's last submap to the path
  int anchor_ = 0;                         ///< SubmapWorld
  int anchor_keyframes_ = 0;               ///< of its part, before this run
  std::optional<PlaceBySubmap> expected_;  ///< of the next keyframe
  std::optional<PosePrior> filter_;        ///< where the particle filter has the newest submap
  MatchPlan plan_;
  WorldUse use_ = WorldUse::kContinue;
  double world_used_ = 0.0;  ///< when it became the world
  PastPath past_;
  int forgotten_ = 0;
  std::optional<WorldThinning> thinning_;
  int thinned_size_ = 0;  ///< submaps when what is needless was left out last
  int thinnings_ = 0;
  bool is_confirmed_ = false;
  int unheld_ = 0;                        ///< own submaps since one with a loop closure
  std::optional<PlaceBySubmap> lost_at_;  ///< where the robot was when it was in the world last
  Pose2 map_T_local_{};                   ///< of the filter's map, as far as known, while there is no own submap
  Pose2 lost_map_T_odom_{};               ///< when the path began
  int newest_query_ = -1;
  int revisited_ = 0;
  bool has_held_back_ = false;
  bool is_to_solve_ = false;
  Phase phase_ = Phase::kIdle;
  Counts counts_;
  MapCorrection next_correction_;
  std::vector<MapCorrection> corrections_;
  std::int64_t revision_ = 0;
};

}  // namespace odoless
