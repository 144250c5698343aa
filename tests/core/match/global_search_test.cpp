#include "core/match/global_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/simulated_scene.hpp"

namespace odoless {
namespace {

constexpr double kResolution_m = 0.05;

/// A room's map, known without error: walls, free space, and nothing known outside of the room.
class SceneSquares final : public MapSquares {
 public:
  SceneSquares(const SimulatedScene& scene, double half_width_m, double half_depth_m)
      : scene_(scene), half_width_m_(half_width_m), half_depth_m_(half_depth_m) {}

  [[nodiscard]] GridGeometry geometry() const override {
    return {.resolution_m = kResolution_m, .columns = 400, .rows = 400};
  }
  [[nodiscard]] bool read(GridCell corner, Square& percent) override {
    bool known = false;
    for (std::size_t i = 0; i < percent.size(); ++i) {
      const int column = corner.column() + static_cast<int>(i % kSide_cells);
      const int row = corner.row() + static_cast<int>(i / kSide_cells);
      const Point2 p{geometry().origin_x_m() + (column + 0.5) * kResolution_m,
                     geometry().origin_y_m() + (row + 0.5) * kResolution_m};
      const bool inside = std::abs(p.x_m) < half_width_m_ + 0.05 && std::abs(p.y_m) < half_depth_m_ + 0.05;
      known = known || inside;
      percent[i] = !inside ? 255 : scene_.clearance_m(p) < 0.6 * kResolution_m ? 90 : 0;
    }
    return known;
  }

 private:
  SimulatedScene scene_;
  double half_width_m_;
  double half_depth_m_;
};

SimulatedScene empty_room() {
  SimulatedScene scene;
  scene.add_box({}, 9.0, 7.0);
  return scene;
}

GlobalSearch search_of(MapSquares& map) { return {GlobalSearchParams{}, map.geometry(), 400}; }

void finish(GlobalSearch& search, MapSquares& map, int slice) {
  while (!search.is_done() && !search.is_idle()) {
    ASSERT_LT(search.work(map, slice), slice + search.step_evaluations_max());
  }
}

bool is_near(const ScoredPoint& found, const Pose2& pose) {
  return to_pose(found.point).distance_m(pose) < 0.1 && std::abs(wrap_angle(found.point[2] - pose.yaw_rad)) < 0.03;
}

const ScoredPoint& best_of(const GlobalSearch& search) {
  return *std::max_element(search.found().begin(), search.found().end(),
                           [](const ScoredPoint& a, const ScoredPoint& b) { return a.score < b.score; });
}

/// Anywhere in the room with some room around.
Pose2 random_pose(const SimulatedScene& scene, Rng& rng) {
  while (true) {
    const Pose2 pose{rng.uniform(-4.0, 4.0), rng.uniform(-3.0, 3.0), rng.uniform(-3.1, 3.1)};
    if (scene.clearance_m({pose.x_m, pose.y_m}) > 0.35) {
      return pose;
    }
  }
}

TEST(GlobalSearch, FindsARobotThatMayBeAnywhereInTheRoom) {
  const SimulatedScene scene = cluttered_room();
  SceneSquares map(scene, 4.5, 3.5);
  GlobalSearch search = search_of(map);
  finish(search, map, 100'000);
  Rng rng(5);
  for (int i = 0; i < 30; ++i) {
    const Pose2 pose = random_pose(scene, rng);
    search.begin(sweep(scene, {}, pose, rng));
    finish(search, map, 100'000);
    EXPECT_TRUE(is_near(best_of(search), pose)) << i << ": " << best_of(search).score;
    EXPECT_GT(best_of(search).score, 0.5);
  }
}

TEST(GlobalSearch, SeesTheTwinOfEveryPoseInASymmetricRoom) {
  const SimulatedScene scene = empty_room();
  SceneSquares map(scene, 4.5, 3.5);
  GlobalSearch search = search_of(map);
  finish(search, map, 100'000);
  Rng rng(6);
  for (int i = 0; i < 20; ++i) {
    const Pose2 pose = random_pose(scene, rng);
    const Pose2 twin = Pose2{0.0, 0.0, std::numbers::pi} * pose;
    search.begin(sweep(scene, {}, pose, rng));
    finish(search, map, 100'000);
    for (const Pose2& expected : {pose, twin}) {
      const auto found = std::find_if(search.found().begin(), search.found().end(),
                                      [&](const ScoredPoint& candidate) { return is_near(candidate, expected); });
      ASSERT_NE(found, search.found().end()) << i;
      EXPECT_GT(found->score, 0.9 * best_of(search).score);
    }
  }
}

TEST(GlobalSearch, IsTheSameHoweverItIsSliced) {
  const SimulatedScene scene = cluttered_room();
  SceneSquares map(scene, 4.5, 3.5);
  Rng rng(7);
  const ScanFrame scan = sweep(scene, {}, {1.0, -1.0, 0.5}, rng);
  GlobalSearch at_once = search_of(map);
  GlobalSearch in_slices = search_of(map);
  finish(at_once, map, 100'000'000);
  finish(in_slices, map, 997);
  at_once.begin(scan);
  in_slices.begin(scan);
  finish(at_once, map, 100'000'000);
  finish(in_slices, map, 1);
  ASSERT_EQ(at_once.found().size(), in_slices.found().size());
  for (std::size_t i = 0; i < at_once.found().size(); ++i) {
    EXPECT_EQ(at_once.found()[i].point, in_slices.found()[i].point);
  }
}

TEST(GlobalSearch, ReadsTheMapAnewOnceItIsForgotten) {
  SceneSquares square(empty_room(), 4.5, 3.5);
  const SimulatedScene scene = cluttered_room();
  SceneSquares cluttered(scene, 4.5, 3.5);
  GlobalSearch search = search_of(square);
  finish(search, square, 100'000);
  search.forget_map({});
  EXPECT_FALSE(search.has_map());
  finish(search, cluttered, 100'000);
  Rng rng(8);
  const Pose2 pose{-1.5, 0.8, 1.0};
  search.begin(sweep(scene, {}, pose, rng));
  finish(search, cluttered, 100'000);
  EXPECT_TRUE(is_near(best_of(search), pose));
}

TEST(GlobalSearch, FindsNothingInAMapOfNothing) {
  SceneSquares nothing(empty_room(), -1.0, -1.0);
  GlobalSearch search = search_of(nothing);
  finish(search, nothing, 100'000);
  Rng rng(9);
  search.begin(sweep(empty_room(), {}, {}, rng));
  finish(search, nothing, 100'000);
  EXPECT_TRUE(search.is_done());
  EXPECT_TRUE(search.found().empty());
}

TEST(ApartPoses, KeepsTheBestOfEachPlace) {
  ApartPoses poses(2);
  poses.offer({{0.0, 0.0, 0.0}, 0.5});
  poses.offer({{0.1, 0.0, 0.0}, 0.4});  // the same place, worse
  poses.offer({{3.0, 0.0, 0.0}, 0.3});
  poses.offer({{0.0, 0.1, 0.0}, 0.6});  // the same place, better
  poses.offer({{0.0, 0.0, 1.0}, 0.2});  // another, but worse than both
  ASSERT_EQ(poses.poses().size(), 2U);
  EXPECT_EQ(poses.poses()[0].score, 0.6);
  EXPECT_EQ(poses.poses()[1].score, 0.3);
  poses.offer({{0.0, 0.0, 1.0}, 0.35});  // in place of the worst
  EXPECT_EQ(poses.poses()[1].score, 0.35);
  poses.clear();
  EXPECT_TRUE(poses.poses().empty());
}

}  // namespace
}  // namespace odoless
