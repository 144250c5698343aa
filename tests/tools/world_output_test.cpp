// A world file that a replay goes on with, or only finds its way in.
#include "tools/output/world_output.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "firmware/world/world_reader.hpp"
#include "tests/core/graph/graph_drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

constexpr Pose2 kHardly_any_drift{0.001, 0.0, 0.0001};

/// Drives so many rounds in what is there, which the file then has.
void replay_rounds(const std::filesystem::path& file, const RobotParams& params, WorldUse use, int rounds) {
  WorldOutput output(file, "1.2.3", params, use);
  Drive run(ring(18.0, 10.0), kHardly_any_drift, params.graph);
  ASSERT_TRUE(output.world() == nullptr || run.graph.resume(output.world()->world(), use));
  for (int i = 0; i < rounds; ++i) {
    run.drive(kRound);
  }
  run.graph.finish();
  output.write({}, run.graph, run.odom);
}

std::unique_ptr<StoredWorld> world_in(const std::filesystem::path& path) {
  WorldFile file;
  EXPECT_FALSE(file.open_to_read(path).any());
  WorldReading reading = read_world(file, RobotParams{});
  EXPECT_TRUE(reading.world) << reading.wrong;
  return std::move(reading.world);
}

// 340 m, of which it keeps 200.
TEST(WorldOutput, OfARunThatLocalisesIsNothingHoweverLongThatIs) {
  const test::TemporaryFolder folder;
  ASSERT_NO_FATAL_FAILURE(replay_rounds(folder.path() / "w", {}, WorldUse::kContinue, 1));
  const std::string before = test::content_of(folder.path() / "w");
  ASSERT_NO_FATAL_FAILURE(replay_rounds(folder.path() / "w", {}, WorldUse::kLocalise, 5));
  EXPECT_EQ(test::content_of(folder.path() / "w"), before);
}

TEST(WorldOutput, OfAFullWorldHasNoSessionMore) {
  const test::TemporaryFolder folder;
  ASSERT_NO_FATAL_FAILURE(replay_rounds(folder.path() / "w", {}, WorldUse::kContinue, 1));
  RobotParams params;
  params.graph.submaps_max = world_in(folder.path() / "w")->graph.size() + 4;
  ASSERT_NO_FATAL_FAILURE(replay_rounds(folder.path() / "w", params, WorldUse::kContinue, 5));
  EXPECT_EQ(world_in(folder.path() / "w")->sessions.size(), 1U);
}

// What is left out while it runs is left out of the file.
TEST(WorldOutput, IsThinnedAsTheRunIs) {
  const test::TemporaryFolder folder;
  RobotParams params;
  params.graph.submaps_max = 56;
  for (int i = 0; i < 2; ++i) {
    ASSERT_NO_FATAL_FAILURE(replay_rounds(folder.path() / "w", params, WorldUse::kContinue, 4));
    EXPECT_LT(world_in(folder.path() / "w")->graph.size(), 42) << i;
  }
  EXPECT_EQ(world_in(folder.path() / "w")->sessions.size(), 2U);
}

}  // namespace
}  // namespace odoless
