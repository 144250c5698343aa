// A run that goes over from mapping to localising and back, and a world that is full.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

constexpr Pose2 kDrift_per_m{0.002, 0.0, 0.0002};
const std::vector<Point2> kHalf{{-10.5, -6.5}, {10.5, -6.5}, {10.5, 6.5}};
const std::vector<Point2> kHalfBack{{10.5, 6.5}, {10.5, -6.5}, {-10.5, -6.5}};
const std::vector<Point2> kOtherHalf{{-10.5, -6.5}, {-10.5, 6.5}, {10.5, 6.5}, {10.5, -6.5}};

/// A run whose map begins where it begins.
struct Mapping : Drive {
  explicit Mapping(const GraphParams& params = {}) : Drive(ring(18.0, 10.0), kDrift_per_m, params) {}
  [[nodiscard]] double error_m() const {
    return (graph.guess().value_or(graph.map_T_odom()) * odom.back().map_T_scan)
        .distance_m(poses.front().inverse() * poses.back());
  }
};

/// Where a graph's world lies, and what holds it together, to the last bit.
struct Places {
  explicit Places(const SubmapGraph& graph) : keyframes(graph.mapped_keyframes()) {
    const std::size_t submaps = graph.map().submaps.size();
    poses.assign(graph.graph().poses().begin(), graph.graph().poses().begin() + static_cast<std::ptrdiff_t>(submaps));
    for (const Constraint& each : graph.graph().constraints()) {
      if (static_cast<std::size_t>(std::max(each.from, each.to)) < submaps) {
        weights.push_back(each.weight);
      }
    }
  }
  [[nodiscard]] bool operator==(const Places& other) const {
    return keyframes == other.keyframes && weights == other.weights && poses.size() == other.poses.size() &&
           std::memcmp(poses.data(), other.poses.data(), poses.size() * sizeof(Pose2)) == 0;
  }

  int keyframes;
  std::vector<Pose2> poses;
  std::vector<double> weights;
};

TEST(WorldUse, ARunLocalisesInWhatItHasMapped) {
  Mapping run;
  run.drive(kRound);
  run.drive({kRound[0], {0.0, -6.5}});
  run.graph.go_over(WorldUse::kLocalise);
  ASSERT_TRUE(run.graph.is_localising());
  const Places before(run.graph);
  EXPECT_TRUE(run.graph.is_in_world()) << "nothing has to be looked for";
  double worst_m = run.error_m();
  run.drive({{0.0, -6.5}, kRound[1]});
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k + 1 < kRound.size(); ++k) {
      run.drive({kRound[(k + 1) % 4], kRound[(k + 2) % 4]});
      EXPECT_TRUE(run.graph.is_in_world()) << i << ", " << k;
      worst_m = std::max(worst_m, run.error_m());
    }
  }
  EXPECT_LT(worst_m, 0.2);
  EXPECT_GT(run.graph.forgotten(), 0);
  EXPECT_TRUE(Places(run.graph) == before);
  run.graph.finish();
  EXPECT_TRUE(Places(run.graph) == before);
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.25) << "of the trajectory, before and after";
}

TEST(WorldUse, ARunGoesOnMappingWhereItHasLocalised) {
  Mapping run;
  run.drive(kHalf);
  run.graph.go_over(WorldUse::kLocalise);
  const Places before(run.graph);
  run.drive(kHalfBack);
  EXPECT_TRUE(Places(run.graph) == before);
  EXPECT_TRUE(run.graph.is_in_world());
  run.graph.go_over(WorldUse::kContinue);
  EXPECT_FALSE(run.graph.is_localising());
  EXPECT_TRUE(run.graph.is_in_world()) << "nothing has to be looked for";
  run.drive(kOtherHalf);
  EXPECT_TRUE(run.graph.is_in_world());
  EXPECT_LT(run.error_m(), 0.2);
  EXPECT_GT(run.graph.submaps().size(), before.poses.size() + 5);
  run.graph.finish();
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.3);
}

TEST(WorldUse, APathThatIsNotSureBeginsAnewBeforeTheMapGrows) {
  Mapping mapped;
  mapped.drive(kRound);
  mapped.graph.finish();
  Drive run(ring(18.0, 10.0), kDrift_per_m);
  ASSERT_TRUE(run.graph.resume(mapped.graph.world(), WorldUse::kLocalise));
  run.drive({kRound[0], {-9.5, -6.5}});
  ASSERT_FALSE(run.graph.is_in_world());
  run.graph.go_over(WorldUse::kContinue);
  EXPECT_FALSE(run.graph.is_joined());
  EXPECT_EQ(run.graph.keyframes().size(), mapped.graph.keyframes().size());
  run.drive({{-9.5, -6.5}, kRound[1], kRound[2]});
  EXPECT_TRUE(run.graph.is_joined());
  EXPECT_GT(run.graph.submaps().size(), mapped.graph.submaps().size());
}

TEST(WorldUse, ARunThatGoesOverWithoutAMapGoesOnMapping) {
  Mapping run;
  run.graph.go_over(WorldUse::kLocalise);
  EXPECT_FALSE(run.graph.is_localising());
  run.drive({kRound[0], {-10.0, -6.5}});
  run.graph.go_over(WorldUse::kLocalise);
  EXPECT_TRUE(run.graph.is_localising()) << "in the submap that had begun";
  EXPECT_TRUE(run.graph.is_in_world());
}

TEST(WorldUse, AnUnjoinedPathIsKeptAndNotLookedForInItself) {
  Mapping mapped;
  mapped.drive(kHalf);
  mapped.graph.finish();
  Drive run(hotel(), kDrift_per_m);
  ASSERT_TRUE(run.graph.resume(mapped.graph.world()));
  run.drive({{1.0, 0.0}, {22.0, 0.0}});
  ASSERT_FALSE(run.graph.is_in_world());
  run.graph.go_over(WorldUse::kLocalise);
  EXPECT_GT(run.graph.first_submap(), mapped.graph.submaps().size() + 2);
  run.drive({{22.0, 0.0}, {1.0, 0.0}, {22.0, 0.0}});
  EXPECT_FALSE(run.graph.is_in_world());
}

TEST(WorldUse, AWorldThatIsFullStaysAsItIs) {
  GraphParams params;
  params.submaps_max = 22;  // of which 5 are left for a path; the others are for a round, none of which is needless
  Mapping run(params);
  run.drive(kRound);
  run.drive(kRound);
  ASSERT_TRUE(run.graph.is_full());
  EXPECT_TRUE(run.graph.is_localising());
  const Places before(run.graph);
  for (int i = 0; i < 3; ++i) {
    run.drive(kRound);
    EXPECT_TRUE(run.graph.is_in_world()) << i;
    EXPECT_LT(run.error_m(), 0.2) << i;
  }
  EXPECT_TRUE(run.graph.is_full());
  EXPECT_LE(run.graph.submaps().size(), 22U);
  EXPECT_TRUE(Places(run.graph) == before);
}

TEST(WorldUse, AWorldThatIsFullIsSearchedWithTheRoomThatIsLeft) {
  Mapping mapped;
  mapped.drive(kRound);
  mapped.graph.finish();
  GraphParams params;
  params.submaps_max = static_cast<int>(mapped.graph.submaps().size()) + 4;
  Drive run(ring(18.0, 10.0), kDrift_per_m, params);
  ASSERT_TRUE(run.graph.resume(mapped.graph.world()));
  ASSERT_TRUE(run.graph.is_localising());
  Drive other(hotel(), kDrift_per_m, params);
  ASSERT_TRUE(other.graph.resume(mapped.graph.world()));
  other.drive({{1.0, 0.0}, {50.0, 0.0}});
  EXPECT_FALSE(other.graph.is_in_world());
  EXPECT_GT(other.graph.forgotten(), 3) << "however long the search takes";
  run.drive({{10.5, -3.0}, {10.5, 6.5}, {-10.5, 6.5}, {-10.5, -2.0}});
  EXPECT_TRUE(run.graph.is_in_world());
}

TEST(WorldUse, AWorldThatIsFullIsResumedAsItIs) {
  Mapping mapped;
  mapped.drive(kRound);
  mapped.graph.finish();
  for (const bool is_full : {true, false}) {
    GraphParams params;
    params.submaps_max = static_cast<int>(mapped.graph.submaps().size()) * (is_full ? 5 : 6) / 4;
    SubmapGraph graph(params, RobotLimits{}, ScanParams{}, 1);
    ASSERT_TRUE(graph.resume(mapped.graph.world()));
    EXPECT_EQ(graph.is_full(), is_full);
    EXPECT_EQ(graph.is_localising(), is_full);
  }
}

}  // namespace
}  // namespace odoless
