// A world file without what newer visits have made needless.
#include "firmware/world/thinned_world.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "firmware/world/continued_world.hpp"
#include "firmware/world/world_reader.hpp"
#include "tests/core/graph/graph_drive.hpp"
#include "tests/firmware/world_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

/// Pools that two days in the ring fill to three quarters, or do not.
RobotParams params(int submaps_max) {
  RobotParams params;
  params.graph.submaps_max = submaps_max;
  return params;
}

/// A file with sessions of a round each.
class ThinnedWorld : public ::testing::Test {
 protected:
  void SetUp() override {
    static const test::TemporaryFolder kept;
    if (const std::filesystem::path two_days = kept.path() / "w"; std::filesystem::exists(two_days)) {
      std::filesystem::copy_file(two_days, path());
    } else {
      ASSERT_NO_FATAL_FAILURE(go_on(512));
      ASSERT_NO_FATAL_FAILURE(go_on(512));
      std::filesystem::copy_file(path(), two_days);
    }
  }

  /// @return  Submaps that were left out before.
  void go_on(int submaps_max) {
    WorldFile file;
    ASSERT_FALSE(file.open_to_write(path(), "1").any());
    ContinuedWorld continued;
    ASSERT_FALSE(continued.read(file, params(submaps_max), WorldUse::kContinue).any());
    left_out_ = continued.make_room(file, params(submaps_max).graph);
    Drive run(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
    ASSERT_TRUE(continued.stored() == nullptr || run.graph.resume(continued.stored()->world()));
    run.drive(kRound);
    run.graph.finish();
    ASSERT_TRUE(run.graph.is_joined());
    WorldPlace place;
    ASSERT_FALSE(file.begin({}, place).any());
    WorldMirror mirror = continued.mirror();
    test::append(file, {.session = place.session}, mirror, run.graph, run.odom);
    file.close();
  }

  [[nodiscard]] std::unique_ptr<StoredWorld> read() const {
    WorldFile file;
    EXPECT_FALSE(file.open_to_read(path()).any());
    WorldReading reading = read_world(file, RobotParams{});
    EXPECT_TRUE(reading.world) << reading.wrong;
    return std::move(reading.world);
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "w"; }

  test::TemporaryFolder folder_;
  int left_out_ = 0;
};

TEST_F(ThinnedWorld, IsReadAsItWasMade) {
  const std::unique_ptr<StoredWorld> before = read();
  const std::unique_ptr<StoredWorld> thin = thinned(*before);
  ASSERT_TRUE(thin);
  EXPECT_LT(thin->graph.size(), 0.6 * before->graph.size());
  WorldFile file;
  ASSERT_FALSE(file.open_to_write(path(), "1").any());
  const std::int64_t revision = file.identity().revision;
  ASSERT_FALSE(leave_out(file, *before, *thin).any());
  EXPECT_EQ(file.identity().revision, revision + 1);
  EXPECT_EQ(file.damage(), "");
  file.close();
  const std::unique_ptr<StoredWorld> after = read();
  ASSERT_EQ(after->store.size(), thin->store.size());
  for (int i = 0; i < thin->store.size(); ++i) {
    EXPECT_TRUE(test::is_same(after->store[i], thin->store[i])) << i;
  }
  ASSERT_EQ(after->graph.size(), thin->graph.size());
  EXPECT_EQ(after->graph.constraints().size(), thin->graph.constraints().size());
  for (int i = 0; i < thin->graph.size(); ++i) {
    EXPECT_TRUE(test::is_same(after->graph.pose(i), thin->graph.pose(i))) << i;
    EXPECT_EQ(after->submaps[static_cast<std::size_t>(i)].first_keyframe,
              thin->submaps[static_cast<std::size_t>(i)].first_keyframe);
  }
  ASSERT_EQ(after->sessions.size(), 2U) << "each has its record";
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after->sessions[i].keyframes, thin->sessions[i].keyframes) << i;
    EXPECT_EQ(after->sessions[i].submaps, thin->sessions[i].submaps) << i;
    EXPECT_EQ(after->sessions[i].odometry.empty(), after->sessions[i].submaps == 0) << i;
    EXPECT_EQ(after->sessions[i].odometry.size(), thin->sessions[i].odometry.size()) << i;
    if (after->sessions[i].submaps > 0) {
      EXPECT_EQ(after->sessions[i].odometry.front().stamp_ns, after->store[after->sessions[i].first_keyframe].stamp_ns)
          << "nothing before it has a place in the map";
    }
  }
  EXPECT_FALSE(thinned(*after)) << "nothing is needless any more";
}

TEST_F(ThinnedWorld, HasTheRobotWhereItWas) {
  const std::unique_ptr<StoredWorld> before = read();
  const std::unique_ptr<StoredWorld> thin = thinned(*before);
  const auto place_in = [](const StoredWorld& world) {
    const PlaceBySubmap place = *last_place(world);
    return world.graph.pose(place.submap) * place.submap_T_scan;
  };
  EXPECT_LT(place_in(*thin).distance_m(place_in(*before)), 1e-9);
}

// Day after day, in as much room as the place needs.
TEST_F(ThinnedWorld, MakesRoomOnlyWhereItIsShort) {
  ASSERT_NO_FATAL_FAILURE(go_on(512));
  EXPECT_EQ(left_out_, 0);
  const int before = read()->graph.size();
  int left_out = 0;
  for (int day = 0; day < 3; ++day) {
    ASSERT_NO_FATAL_FAILURE(go_on(before));
    left_out += left_out_;
    EXPECT_LE(read()->graph.size(), before) << day;
  }
  EXPECT_GT(left_out, before / 4);
}

TEST_F(ThinnedWorld, StaysAsItIsWhereItCannotBeWritten) {
  WorldFile file;
  ASSERT_FALSE(file.open_to_read(path()).any());
  ContinuedWorld continued;
  ASSERT_FALSE(continued.read(file, params(24), WorldUse::kContinue).any());
  const int before = continued.stored()->graph.size();
  EXPECT_EQ(continued.make_room(file, params(24).graph), 0);
  EXPECT_EQ(continued.stored()->graph.size(), before);
}

}  // namespace
}  // namespace odoless
