#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/rng.hpp"
#include "core/graph/graph_params.hpp"
#include "core/graph/path_scan.hpp"
#include "core/graph/place_fit.hpp"
#include "core/graph/submap_matcher.hpp"
#include "core/graph/world_search.hpp"

namespace odoless {

/// That a piece of the path lies at an older submap.
struct PieceMatch {
  int reference = 0;
  int keyframe = 0;          ///< whose frame the piece's is
  bool is_expected = false;  ///< somebody said that the robot is there
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Pose2 reference_T_keyframe{};
};

/// Finds out where a path lies in a world of which it is no part yet: global localisation. The path is cut into pieces
/// of about a metre, but for its first scan, which is one by itself. Each is searched in all submaps that tell places
/// (world_parts.hpp) and matched where it may be. What a match is worth is the logarithm of the odds that it is right,
/// by its score and by how many of the piece's beams it explains. Where matches of several pieces agree on where the
/// odom frame lies, are worth enough together, and no other place comes near, the last metres of the path are matched
/// there as a whole; only if they fit too the path is found: a single match is often wrong where the right place is not
/// in the world.
///
/// Thread: owned by one thread. Not for real-time threads: one step of the work takes up to 20 ms. Memory is fixed at
/// construction, but for scratch.
class Localiser {
 public:
  Localiser(const GraphParams& params, const ScanParams& scan);

  /// Somebody says where the robot is, or was when it was last seen: it counts as a match would, until there are more.
  /// @param component  Of the graph, in whose frame that is.
  void expect(int component, const Pose2& map_T_scan, const Pose2& odom_T_scan);
  /// Every keyframe of the path, in the store. Those that come while a piece is searched are the next ones, unless the
  /// work falls behind by the metres of path that are kept.
  void add(const KeyframeStore& store, int keyframe);
  [[nodiscard]] bool has_work() const { return stage_ != Stage::kIdle; }
  /// One step. @param submaps  The first so many of the world are searched.
  /// @return  Whether there is more.
  bool work(const SubmapWorld& world, int submaps, SubmapMatcher& matcher, Rng& rng);
  /// map_T_odom that the last metres of the path speak for; none: nothing does. It may be wrong: parts of a building,
  /// or of two, are alike.
  [[nodiscard]] const std::optional<Pose2>& guess() const { return guess_; }
  /// The match of the last metres once enough of the path has agreed with it, or it is where the robot was expected.
  [[nodiscard]] const std::optional<PieceMatch>& found() const { return found_; }
  /// From here on the path is another one.
  void forget();
  /// So many keyframes from that one on are no more, which are the path's oldest. While there is no work.
  void renumber(int first, int keyframes);

 private:
  enum class Stage : std::uint8_t { kIdle, kLook, kMatch, kVerify };

  struct Candidate {
    std::int64_t piece = 0;
    int component = 0;  ///< of the graph
    Pose2 map_T_odom{};
    double worth = 0.0;
    PieceMatch match;
  };
  /// Candidates that agree.
  struct Agreement {
    std::vector<std::size_t> members;  ///< the best of each piece
    double worth = 0.0;
    bool is_sure = false;  ///< enough to be found, if the path as a whole fits there
  };

  /// If there is none, and the path that was not searched yet is long enough or the search is hurried.
  void begin_next_piece(const KeyframeStore& store);
  /// That part of the path, about its middle.
  void take_piece(std::size_t begin, std::size_t end);
  /// How good a match of the piece is; none: it says nothing.
  [[nodiscard]] std::optional<double> quality(const SubmapWorld& world, int reference, const SubmapMatch& match);
  void take_places();
  void try_place(const SubmapWorld& world, SubmapMatcher& matcher, Rng& rng);
  /// The best candidates that agree, if they are worth a guess; none if not.
  [[nodiscard]] Agreement judge(int submaps) const;
  void verify(const SubmapWorld& world, SubmapMatcher& matcher, Rng& rng);
  [[nodiscard]] bool agree(const Candidate& a, const Candidate& b) const;
  [[nodiscard]] bool is_expected(const Candidate& candidate) const;
  [[nodiscard]] bool are_apart(const Candidate& a, const Candidate& b) const;
  [[nodiscard]] Agreement agreeing_with(const Candidate& with) const;

  /// A keyframe of the path and how long the path was there.
  struct PathPoint {
    PathScan odom;  ///< in the odom frame
    double way_m = 0.0;
  };

  WorldSearch search_;
  PlaceFit fit_;
  std::vector<PathPoint> path_;  ///< its last metres
  std::size_t piece_begin_ = 0;  ///< in the path
  std::vector<PathScan> piece_;
  Pose2 odom_T_piece_{};
  std::int64_t pieces_ = 0;
  std::optional<Pose2> expected_map_T_odom_;
  int expected_component_ = 0;
  bool is_hurried_ = true;  ///< a piece of one scan does: the path has just begun, or somebody has said where it lies
  Stage stage_ = Stage::kIdle;
  int next_ = 0;             ///< submap to be looked at
  std::vector<bool> tells_;  ///< of those, whether the piece may be at it
  std::vector<FoundPlace> places_;
  std::vector<Candidate> candidates_;
  Agreement agreement_;  ///< to be verified
  std::optional<Pose2> guess_;
  std::optional<PieceMatch> found_;
};

}  // namespace odoless
