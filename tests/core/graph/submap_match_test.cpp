// A submap or a piece of a path in an older submap: searched all over, matched, and judged beam by beam.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/graph/place_fit.hpp"
#include "core/graph/submap_matcher.hpp"
#include "core/graph/world_search.hpp"
#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kDrivePeriod_ns = 200'000'000;  // of the drive's scans
constexpr double kNear_m = 2.0;
constexpr double kFar_m = 15.0;

struct Pair {
  int older = 0;
  int newer = 0;
  Pose2 older_T_newer{};  ///< true
};

/// Two rounds of the ring, with an odometry that does not err: each place is in an older submap and in a newer one.
struct TwoRounds : Drive {
  TwoRounds() : Drive(ring(18.0, 10.0), {}) {
    drive(kRound);
    round_ends = graph.submaps().size();
    drive(kRound);
    graph.finish();
  }
  [[nodiscard]] Pose2 truth(int submap) const {
    return poses[static_cast<std::size_t>(graph.submaps()[static_cast<std::size_t>(submap)].origin_stamp_ns /
                                          kDrivePeriod_ns)];
  }
  /// Of the rounds, whose origins are that far apart.
  [[nodiscard]] std::vector<Pair> pairs(double least_m, double most_m) const {
    std::vector<Pair> out;
    for (int older = 1; older + 1 < static_cast<int>(round_ends); ++older) {
      for (auto newer = static_cast<int>(round_ends) + 1; newer < graph.graph().size(); ++newer) {
        const Pose2 older_T_newer = truth(older).inverse() * truth(newer);
        const double distance_m = older_T_newer.distance_m({});
        if (least_m <= distance_m && distance_m < most_m) {
          out.push_back({older, newer, older_T_newer});
        }
      }
    }
    return out;
  }
  [[nodiscard]] std::vector<PathScan> piece(int submap) const {
    const Submap& of = graph.submaps()[static_cast<std::size_t>(submap)];
    std::vector<PathScan> out;
    for (int k = of.first_keyframe; k < of.end_keyframe(); ++k) {
      out.push_back({k, graph.keyframes().submap_T_scan(k)});
    }
    return out;
  }

  std::size_t round_ends = 0;
};

const TwoRounds& rounds() {
  static const TwoRounds run;
  return run;
}

bool are_near(const Pose2& a, const Pose2& b, double apart_m, double apart_rad) {
  return a.distance_m(b) < apart_m && std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < apart_rad;
}

class MatchOfSubmaps : public ::testing::Test {
 protected:
  SubmapMatch match(const Pair& pair, const SubmapSearch& where) {
    matcher_.set_query(rounds().graph.world(), pair.newer);
    return matcher_.match(rounds().graph.world(), pair.older, where, rng_);
  }

  SubmapMatcher matcher_{GraphParams{}, ScanParams{}};
  Rng rng_{1};
};

TEST_F(MatchOfSubmaps, IsWhereTheSubmapLiesFromWhereverInItsBoxItIsLookedFor) {
  const std::vector<Pair> pairs = rounds().pairs(0.0, kNear_m);
  ASSERT_GT(pairs.size(), 8U);
  for (const Pair& pair : pairs) {
    for (const Pose2& off : {Pose2{}, Pose2{0.7, -0.5, 0.15}, Pose2{-0.6, 0.7, -0.2}}) {
      const SubmapMatch found = match(pair, {pair.older_T_newer * off, 1.2, 0.3});
      EXPECT_TRUE(are_near(found.reference_T_query, pair.older_T_newer, 0.1, 0.02)) << pair.older << ", " << pair.newer;
      EXPECT_TRUE(found.is_inside);
      EXPECT_GT(found.score, 0.5);
      EXPECT_LE(found.score, 1.0);
      EXPECT_GT(found.agreement, 0.95);
      EXPECT_GT(found.coverage, 0.85);
      EXPECT_LE(found.coverage, 1.0);
    }
  }
}

TEST_F(MatchOfSubmaps, IsNoneWhereTheSubmapIsNot) {
  const std::vector<Pair> pairs = rounds().pairs(kFar_m, 100.0);
  ASSERT_GT(pairs.size(), 8U);
  int like = 0;
  for (const Pair& pair : pairs) {
    const SubmapMatch found = match(pair, {{}, 1.0, 0.3});
    like += found.is_inside && found.agreement > 0.95 && found.coverage > 0.85 && !found.is_weak ? 1 : 0;
  }
  EXPECT_EQ(like, 0);
}

TEST_F(MatchOfSubmaps, CoversLessTheLessTheyOverlap) {
  const auto mean_coverage = [&](double least_m, double most_m) {
    const std::vector<Pair> pairs = rounds().pairs(least_m, most_m);
    EXPECT_FALSE(pairs.empty());
    double sum = 0.0;
    for (const Pair& pair : pairs) {
      sum += match(pair, {pair.older_T_newer, 0.3, 0.1}).coverage;
    }
    return sum / static_cast<double>(pairs.size());
  };
  const double near = mean_coverage(0.0, 2.0);
  const double half = mean_coverage(7.0, 9.0);
  const double far = mean_coverage(12.0, 15.0);
  EXPECT_GT(near, half);
  EXPECT_GT(half, far + 0.1);
}

// What is ready in a matcher saves time and changes nothing.
TEST_F(MatchOfSubmaps, IsTheSameOfACopyAndOfWhatIsMadeReadyAnew) {
  const std::vector<Pair> pairs = rounds().pairs(0.0, kNear_m);
  const Pair& pair = pairs.front();
  const SubmapSearch where{pair.older_T_newer * Pose2{0.4, 0.2, 0.1}, 1.0, 0.3};
  const Rng seed(7);
  const auto found_by = [&](SubmapMatcher& matcher) {
    Rng rng = seed;
    matcher.set_query(rounds().graph.world(), pair.newer);
    return matcher.match(rounds().graph.world(), pair.older, where, rng).reference_T_query;
  };
  const Pose2 first = found_by(matcher_);
  for (const Pair& other : pairs) {  // more than are kept ready
    static_cast<void>(match(other, where));
  }
  const Pose2 again = found_by(matcher_);
  matcher_.forget(pair.older);
  const Pose2 anew = found_by(matcher_);
  SubmapMatcher copy(matcher_);
  const Pose2 by_copy = found_by(copy);
  for (const Pose2& each : {again, anew, by_copy}) {
    EXPECT_TRUE(each.x_m == first.x_m && each.y_m == first.y_m && each.yaw_rad == first.yaw_rad);
  }
}

TEST(PlaceFitOfAPiece, SpeaksForItsPlaceAndAgainstOthers) {
  PlaceFit fit(ScanParams{}, GraphParams{}.keyframe_beams_max);
  const std::vector<Pair> pairs = rounds().pairs(0.0, kNear_m);
  ASSERT_GT(pairs.size(), 8U);
  for (const Pair& pair : pairs) {
    const std::vector<PathScan> piece = rounds().piece(pair.newer);
    const auto explained = [&](const Pose2& off) {
      return fit.explained(rounds().graph.world(), pair.older, piece, pair.older_T_newer * off);
    };
    EXPECT_GT(explained({}), 0.95) << pair.older << ", " << pair.newer;
    EXPECT_LT(explained({0.0, 0.0, 0.3}), 0.8) << pair.older << ", " << pair.newer;
    EXPECT_LT(explained({0.0, 1.5, 0.0}), 0.8) << "through a wall of the corridor";
  }
}

TEST(PlaceFitOfAPiece, SaysNothingWhereNothingIsKnown) {
  PlaceFit fit(ScanParams{}, GraphParams{}.keyframe_beams_max);
  EXPECT_EQ(fit.explained(rounds().graph.world(), 1, rounds().piece(1), {300.0, 0.0, 0.0}), 0.0);
}

TEST(WorldSearchOfAPiece, FindsItsPlaceAmongThoseThatItTells) {
  WorldSearch search(ScanParams{}, GraphParams{}.keyframe_beams_max);
  const std::vector<Pair> pairs = rounds().pairs(0.0, kNear_m);
  ASSERT_GT(pairs.size(), 8U);
  for (const Pair& pair : {pairs.front(), pairs[pairs.size() / 2], pairs.back()}) {
    search.begin(rounds().graph.keyframes(), rounds().piece(pair.newer));
    for (int submap = 0; submap < static_cast<int>(rounds().round_ends); ++submap) {
      search.look(rounds().graph.world(), submap);
    }
    const auto found = search.found();
    ASSERT_FALSE(found.empty());
    bool is_found = false;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(i == 0 || found[i].score <= found[i - 1].score) << "best first";
      EXPECT_LE(found[i].score, 1.0);
      const Pose2 place = rounds().truth(found[i].submap) * found[i].submap_T_piece;
      is_found = is_found ||
                 (found[i].score > 0.75 * found[0].score && are_near(place, rounds().truth(pair.newer), 0.4, 0.08));
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_FALSE(found[k].submap == found[i].submap &&
                     are_near(found[k].submap_T_piece, found[i].submap_T_piece, 0.5, 0.1))
            << "one place twice";
      }
    }
    EXPECT_TRUE(is_found) << pair.newer;
  }
}

TEST(WorldSearchOfAPiece, OfNothingFindsNothing) {
  WorldSearch search(ScanParams{}, GraphParams{}.keyframe_beams_max);
  search.begin(rounds().graph.keyframes(), {});
  search.look(rounds().graph.world(), 1);
  EXPECT_TRUE(search.found().empty());
}

}  // namespace
}  // namespace odoless
