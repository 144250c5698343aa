#include <gtest/gtest.h>

#include <cmath>

#include "core/base/rng.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/sim/building.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

Building random_building(Rng& rng) {
  Building building{.ceiling_m = rng.uniform(2.0, 3.0)};
  for (int i = 0; i < 10; ++i) {
    const double bottom_m = rng.uniform(0.0, 1.0);
    building.panels.push_back({{test::random_point(rng, 5.0), test::random_point(rng, 5.0)}, bottom_m, bottom_m + 1.0});
    building.columns.push_back({{test::random_point(rng, 5.0), rng.uniform(0.05, 0.5)}, bottom_m, bottom_m + 0.8});
    const Point2 middle = test::random_point(rng, 5.0);
    building.slabs.push_back(
        {{middle.x_m, middle.y_m, rng.uniform(-3.0, 3.0)}, rng.uniform(0.2, 2.0), rng.uniform(0.2, 2.0), bottom_m});
  }
  return building;
}

Point3 at(const Point3& origin, const Point3& direction, double range_m) {
  return {origin.x_m + range_m * direction.x_m, origin.y_m + range_m * direction.y_m,
          origin.z_m + range_m * direction.z_m};
}

/// Goes along the ray by the distance to whatever is nearest, until something is reached: the oracle of cast_ray_m,
/// which needs distance_m alone.
double marched_m(const Building& building, const Point3& origin, const Point3& direction) {
  double range_m = 0.0;
  for (int step = 0; step < 20'000; ++step) {
    const double free_m = distance_m(building, at(origin, direction, range_m));
    if (free_m < 1e-7) {
      return range_m;
    }
    range_m += free_m;
  }
  return range_m;
}

// In panels that are seen at a grazing angle the march ends early by its bound, hence the tolerance.
TEST(Building, RaysEndWhereAMarchDoes) {
  Rng rng(11);
  for (int run = 0; run < 300; ++run) {
    const Building building = random_building(rng);
    const Point3 origin{rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0), rng.uniform(0.2, building.ceiling_m - 0.2)};
    const double azimuth_rad = rng.uniform(-3.0, 3.0);
    const double elevation_rad = rng.uniform(-1.2, 1.2);
    const Point3 direction{std::cos(elevation_rad) * std::cos(azimuth_rad),
                           std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
    const double range_m = cast_ray_m(building, origin, direction);
    EXPECT_NEAR(range_m, marched_m(building, origin, direction), 1e-4) << run;
    EXPECT_NEAR(distance_m(building, at(origin, direction, range_m)), 0.0, 1e-9) << run;
  }
}

double from_middle_m(const Building& building, const Point3& direction) {
  return cast_ray_m(building, {0.0, 0.0, 1.0}, direction);
}

TEST(Building, WorldFileIsRaised) {
  const World world = parse_world(
      "ceiling 2.5\ndoor_height 2.0\nroom -4 -4 8 8\ndoor 4 0 1.0\nbox_height 0.5\nbox -2 0 1 1\n"
      "table_height 0.8\ntable 0 2 1 1\npillar 0 -2 0.5\ngo 0 0  -1 0\n",
      "test");
  const Building& building = world.building;
  EXPECT_DOUBLE_EQ(from_middle_m(building, {0.0, 0.0, 1.0}), 1.5) << "the ceiling";
  EXPECT_DOUBLE_EQ(from_middle_m(building, {0.0, 0.0, -1.0}), 1.0) << "the floor";
  EXPECT_TRUE(std::isinf(from_middle_m(building, {1.0, 0.0, 0.0}))) << "through the door";
  EXPECT_DOUBLE_EQ(cast_ray_m(building, {0.0, 0.0, 2.2}, {1.0, 0.0, 0.0}), 4.0) << "the lintel above it";
  EXPECT_DOUBLE_EQ(from_middle_m(building, {-1.0, 0.0, 0.0}), 4.0) << "above the box, to the wall";
  EXPECT_DOUBLE_EQ(cast_ray_m(building, {0.0, 0.0, 0.3}, {-1.0, 0.0, 0.0}), 1.5) << "the box";
  EXPECT_DOUBLE_EQ(cast_ray_m(building, {-2.0, 0.0, 1.0}, {0.0, 0.0, -1.0}), 0.5) << "its top";
  EXPECT_DOUBLE_EQ(cast_ray_m(building, {0.0, 2.0, 2.0}, {0.0, 0.0, -1.0}), 1.2) << "the table's top";
  EXPECT_DOUBLE_EQ(cast_ray_m(building, {0.0, 0.0, 0.3}, {0.0, 1.0, 0.0}), 4.0) << "between its legs";
  EXPECT_DOUBLE_EQ(from_middle_m(building, {0.0, -1.0, 0.0}), 1.5) << "the pillar";
  EXPECT_EQ(world.pillars.size(), 5U) << "a level laser sees the pillar and four legs";
}

TEST(Building, CeilingCutsAllThatIsHigher) {
  const World world =
      parse_world("door_height 3\nroom -4 -4 8 8\ndoor 4 0 1\nbox 0 3 1 1\nceiling 2\ngo 0 0  -1 0\n", "t");
  for (const Panel& panel : world.building.panels) {
    EXPECT_LE(panel.top_m, 2.0);
    EXPECT_LT(panel.bottom_m, panel.top_m);
  }
}

}  // namespace
}  // namespace odoless
