#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/tools/sim_support.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_world(text, "my.world"));
  } catch (const DataError& error) {
    EXPECT_EQ(error.exit_code(), 65);
    return error.what();
  }
  return "no error";
}

TEST(WorldFile, ReadsEveryStatement) {
  const World world = parse_world(
      "# a comment\n\n"
      "room 0 0  10 4\r\n"
      "wall 4 0  4 4  6 4   # a polyline\n"
      "door 4 2 1\n"
      "\tbox 8 0.9  2 1  90\n"
      "pillar 9 3 0.25\n"
      "walker 0.3 1.5  1 1  1 3  2 3\n"
      "go 1 2\nspeed 2\nturn_rate 90\ncorner_radius 0\ngo 3 2  5 2\n",
      "my.world");
  EXPECT_EQ(world.segments.size(), 4U + 2U + 1U + 4U);
  ASSERT_EQ(world.pillars.size(), 1U);
  EXPECT_EQ(world.pillars[0].radius_m, 0.25);
  ASSERT_EQ(world.walkers.size(), 1U);
  EXPECT_EQ(world.walkers[0].radius_m, 0.3);
  EXPECT_EQ(world.walkers[0].speed_mps, 1.5);
  ASSERT_EQ(world.walkers[0].waypoints.size(), 3U);
  EXPECT_EQ(world.walkers[0].waypoints[2].x_m, 2.0);
  ASSERT_EQ(world.waypoints.size(), 3U);
  EXPECT_EQ(world.waypoints[0].speed_mps, Waypoint{}.speed_mps);
  EXPECT_EQ(world.waypoints[1].speed_mps, 2.0);
  EXPECT_NEAR(world.waypoints[2].turn_rate_radps, 90.0 * test::kRadPerDeg, 1e-12);
  EXPECT_EQ(world.waypoints[2].corner_radius_m, 0.0);
  EXPECT_EQ(world.waypoints[2].position.x_m, 5.0);
  EXPECT_NEAR(cast_ray_m(world, {5.0, 1.0}, {1.0, 0.0}), 2.5, 1e-9) << "the box turned by 90 deg is 1 m wide";
  EXPECT_NEAR(cast_ray_m(world, {1.0, 2.0}, {1.0, 0.0}), 9.0, 1e-9) << "through the door";
  EXPECT_NEAR(cast_ray_m(world, {1.0, 1.0}, {1.0, 0.0}), 3.0, 1e-9) << "beside the door";
}

TEST(WorldFile, DoorsOpenWallsStatedAfterThemButNoFurniture) {
  const World world = parse_world("door 4 2 1\nwall 4 0 4 4\nbox 4.5 2 0.2 3\ngo 0 0 1 0", "my.world");
  EXPECT_NEAR(cast_ray_m(world, {0.0, 2.0}, {1.0, 0.0}), 4.4, 1e-9);
}

struct Wrong {
  const char* text;
  const char* place;
  const char* right;
};

TEST(WorldFile, ErrorsSayWhereAndWhatWouldBeRight) {
  const std::string go = "\ngo 0 0 1 0\n";
  for (const Wrong& wrong :
       std::initializer_list<Wrong>{{"wal 0 0 1 1", "my.world:1: ", "wall X Y X Y ..."},
                                    {"\n\nwall 0 0 1", "my.world:3: ", "wall X Y X Y ..."},
                                    {"wall 0 0", "my.world:1: ", "wall X Y X Y ..."},
                                    {"# ok\nwall 1 1 1 1", "my.world:2: ", "points that differ"},
                                    {"room 0 0 4", "my.world:1: ", "room X Y WIDTH HEIGHT"},
                                    {"room 0 0 -4 3", "my.world:1: WIDTH in m is -4", "0.001 to 10000"},
                                    {"room 0 0 4 nan", "my.world:1: ", "a finite number"},
                                    {"room 0 0 4 3x", "my.world:1: ", "a finite number"},
                                    {"box 0 0 1 1 1 1", "my.world:1: ", "box X Y WIDTH HEIGHT [YAW_DEG]"},
                                    {"pillar 0 0 0", "my.world:1: RADIUS in m is 0", "0.001 to 10000"},
                                    {"pillar 1e9 0 1", "my.world:1: X in m is 1000000000", "-10000 to 10000"},
                                    {"walker 0.3 1 2 2", "my.world:1: ", "walker RADIUS SPEED X Y X Y ..."},
                                    {"walker 0.3 1 2 2 2 2", "my.world:1: ", "points that differ"},
                                    {"walker 0.3 0 2 2 3 2", "my.world:1: the speed in m/s is 0", "0.01 to 20"},
                                    {"speed 0", "my.world:1: the speed in m/s is 0", "0.01 to 20"},
                                    {"turn_rate -1", "my.world:1: ", "0.1 to 3600"},
                                    {"corner_radius -1", "my.world:1: ", "0 to 100"},
                                    {"door 1 1 1", "my.world:1: door 1 1 opens no wall", "lies on a wall"},
                                    {"go 3 3\n\ngo 3 3", "my.world:3: ", "1 mm apart"},
                                    {"wall 2 -1 2 1\ngo -1 0\ngo 0 0\ngo 5 0",
                                     "my.world:4: the path from 0 0 to 5 0 hits a surface after 2.00 m", "door"}}) {
    EXPECT_THAT(refusal_of(wrong.text + go),
                AllOf(StartsWith(wrong.place), HasSubstr("expected"), HasSubstr(wrong.right)))
        << wrong.text;
  }
  EXPECT_THAT(refusal_of("room 0 0 4 3\ngo 1 1"), AllOf(StartsWith("my.world: "), HasSubstr("two points or more")));
}

TEST(WorldFile, HelpNamesEveryStatement) {
  for (const char* name :
       {"wall", "room", "door", "box", "pillar", "walker", "speed", "turn_rate", "corner_radius", "go"}) {
    EXPECT_THAT(world_statements(), HasSubstr(std::string("  ") + name + " "));
  }
}

TEST(WorldFile, MissingFileIsNoInput) { EXPECT_THROW(static_cast<void>(read_world("no/such.world")), NoInputError); }

TEST(WorldFile, DamagedFilesAreReadOrRefusedButNeverCrash) {
  std::ifstream in(test::example_world("rooms.world"));
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  ASSERT_FALSE(text.empty());
  Rng rng(8);
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = text.substr(0, 1 + rng.below(static_cast<std::uint32_t>(text.size())));
    for (std::uint32_t i = rng.below(6); i > 0; --i) {
      damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] = static_cast<char>(rng.below(256));
    }
    refused += refusal_of(damaged) == "no error" ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace odoless
