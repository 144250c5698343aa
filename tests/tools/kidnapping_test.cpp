// A robot is carried away in a building that it knows. Each run has its own noise, place and way, every tenth its own
// mapping; in CI there are few of them, and as many as ODOLESS_KIDNAPPINGS says by hand:
//   ODOLESS_KIDNAPPINGS=100 build/release/bin/test_tools --gtest_filter='Kidnapped.Knows*'
// and from another seed on than 1: ODOLESS_KIDNAPPINGS_FROM=101, say.
#include "tests/tools/kidnapping.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "rt/heap_guard.hpp"
#include "tests/support/fault_matrix.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

using test::KidnappedRobot;
using test::Kidnapping;

constexpr double kWatched_s = 14.0;

int asked_for(const char* variable, int otherwise) {
  const char* const asked = std::getenv(variable);
  return asked == nullptr ? otherwise : std::max(1, std::atoi(asked));
}

/// The figures of many kidnappings.
struct Tally {
  int runs = 0;
  int said_soon = 0;  ///< or right again before it had to say so
  int found_soon = 0;
  int lies = 0;  ///< sure, or found, for a second, and wrong
  int noticed = 0;
  int wrong_finds = 0;  ///< the search itself put the robot where it was not
  double slice_us_max = 0.0;
  double lost_after_s_max = 0.0;  ///< of those that were lost before they were found
  double found_after_s_max = 0.0;

  void add(const Kidnapping& run) {
    ++runs;
    said_soon += std::min(run.lost_after_s, run.found_after_s) <= 2.0 ? 1 : 0;
    found_soon += run.found_after_s <= 10.0 ? 1 : 0;
    lies += run.wrong_sure_s > 1.0 || run.wrong_claimed_s > 1.0 ? 1 : 0;
    noticed += run.lost_scans > 0 ? 1 : 0;
    wrong_finds += run.wrong_claimed_s > 1.0 ? 1 : 0;
    slice_us_max = std::max(slice_us_max, run.slice_us_max);
    lost_after_s_max = std::max(lost_after_s_max, std::min(run.lost_after_s, run.found_after_s));
    found_after_s_max = std::max(found_after_s_max, run.found_after_s);
  }
};

/// Ten kidnappings from one mapping, at as many places of the last quarter of the path; then another mapping.
Tally kidnap(const World& world) {
  constexpr int kPer_mapping = 10;
  const int runs = asked_for("ODOLESS_KIDNAPPINGS", 3);
  const int first_seed = asked_for("ODOLESS_KIDNAPPINGS_FROM", 1);
  Tally tally;
  std::optional<KidnappedRobot> robot;
  for (int seed = first_seed - (first_seed - 1) % kPer_mapping; tally.runs < runs; ++seed) {
    const int index = (seed - 1) % kPer_mapping;
    if (index == 0) {
      robot.emplace(world, RobotParams{}, static_cast<std::uint64_t>(seed));
    }
    robot->drive_until(0.75 + 0.25 * (index + 0.5) / kPer_mapping);
    if (seed < first_seed) {
      continue;
    }
    KidnappedRobot carried = *robot;
    const Kidnapping run = carried.carry_away(static_cast<std::uint64_t>(seed), kWatched_s);
    if (run.happened) {
      tally.add(run);
      fmt::print(
          "seed {}: lost after {:.1f} s, found after {:.1f} s; sure and wrong for {:.1f} s, found and wrong for {:.1f} "
          "s; "
          "slice at most {:.0f} us\n",
          seed, run.lost_after_s, run.found_after_s, run.wrong_sure_s, run.wrong_claimed_s, run.slice_us_max);
    }
  }
  fmt::print("{} runs: said in time {}, found in time {}, lies {}, longest slice {:.1f} ms\n", tally.runs,
             tally.said_soon, tally.found_soon, tally.lies, 1e-3 * tally.slice_us_max);
  return tally;
}

TEST(Kidnapped, KnowsItWithinTwoSecondsAndFindsItselfWithinTen) {
  const Tally tally = kidnap(read_world(test::example_world("rooms.world")));
  test::measured(25, "flag", tally.lost_after_s_max, "s");
  test::measured(25, "recover", tally.found_after_s_max, "s");
  EXPECT_EQ(tally.said_soon, tally.runs);
  EXPECT_GE(tally.found_soon, 0.95 * tally.runs);
  EXPECT_EQ(tally.lies, 0);
}

// Not a copy of the robot: that has only the memory which it uses, and not what was set aside.
TEST(Kidnapped, AllocatesNothingWhileItIsLostAndWhenItIsFound) {
  if (!heap_is_watched()) {
    GTEST_SKIP() << "the sanitizers have a heap of their own; the released build runs this";
  }
  KidnappedRobot robot(read_world(test::example_world("rooms.world")), RobotParams{}, 1);
  robot.drive_until(0.8);
  const Kidnapping run = robot.carry_away(1, kWatched_s);
  ASSERT_TRUE(run.happened);
  EXPECT_GT(run.lost_scans, 0);
  EXPECT_LT(run.found_after_s, kWatched_s);
  EXPECT_EQ(run.heap_calls, 0);
}

// Every place of an empty rectangle has a twin, half a turn away: nothing that the laser sees tells them apart.
TEST(Kidnapped, StaysLostWhereTwoPlacesLookAlike) {
  const World world = parse_world("room 0 0 9 6\nspeed 0.5\ngo 1 1  8 1  8 5  1 5  1 1  4 3", "symmetric");
  const Tally tally = kidnap(world);
  EXPECT_GT(tally.noticed, 0);
  EXPECT_EQ(tally.wrong_finds, 0);
}

}  // namespace
}  // namespace odoless
