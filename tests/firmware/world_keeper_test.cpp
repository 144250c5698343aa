// A world file that follows its graph: closed where the robot only finds its way, opened again to map.
#include "firmware/world/world_keeper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "core/graph/keyframe_gate.hpp"
#include "firmware/world/world_reader.hpp"
#include "tests/core/graph/graph_drive.hpp"
#include "tests/firmware/world_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

/// The way around the ring of corridors, in steps of a scan.
std::vector<Pose2> around() {
  constexpr int kSteps_per_m = 4;
  constexpr int kTurn_steps = 8;
  std::vector<Pose2> poses;
  for (std::size_t side = 0; side + 1 < kRound.size(); ++side) {
    const Point2 from = kRound[side];
    const Point2 to = kRound[side + 1];
    const double heading_rad = std::atan2(to.y_m - from.y_m, to.x_m - from.x_m);
    const int steps = static_cast<int>(kSteps_per_m * std::hypot(to.x_m - from.x_m, to.y_m - from.y_m));
    for (int k = 0; k < steps; ++k) {
      poses.push_back(
          {from.x_m + (to.x_m - from.x_m) * k / steps, from.y_m + (to.y_m - from.y_m) * k / steps, heading_rad});
    }
    for (int k = 0; k < kTurn_steps; ++k) {
      poses.push_back({to.x_m, to.y_m, wrap_angle(heading_rad + 0.5 * std::numbers::pi * k / kTurn_steps)});
    }
  }
  return poses;
}

/// A robot that goes round and round, with a graph and a file that is kept up with it.
class KeptWorld : public ::testing::Test {
 protected:
  void SetUp() override { start({}, WorldUse::kContinue); }

  /// Anew, as a daemon that is started again.
  void start(const GraphParams& graph, WorldUse mode) {
    keeper_.reset();
    RobotParams params;
    params.graph = graph;
    feed_ = std::make_unique<GraphFeed>(params, 1, true);
    keeper_ = std::make_unique<WorldKeeper>(WorldParams{.file = path().string(), .mode = mode, .write_every_s = 0.1},
                                            SessionRecord{"", "1.2.3", "", 1});
    feed_->tell([this](const Keyframe& keyframe, std::span<const BeamCode> codes) { keeper_->add(keyframe, codes); },
                [this](WorldUse use, int map, int keyframes) { keeper_->follow(use, map, keyframes); });
    const FileFailure failed = keeper_->open(*feed_);
    ASSERT_FALSE(failed.any()) << failed.text;
    ASSERT_EQ(feed_->start(), 0);
    ASSERT_EQ(keeper_->start(*feed_), 0);
  }

  void drive(int scans) {
    for (int i = 0; i < scans; ++i) {
      const std::int64_t stamp_ns = ++scans_ * kPeriod_ns;
      const Pose2 world_T_scan = way_[static_cast<std::size_t>(scans_) % way_.size()];
      Motion motion;
      if (scans_ > 1) {
        motion = Motion::between(stamp_ns - kPeriod_ns, stamp_ns, world_T_before_.inverse() * world_T_scan);
      }
      world_T_before_ = world_T_scan;
      motion.odom_T_current = world_T_start_.inverse() * world_T_scan;
      const ScanFrame scan =
          sweep(scene_, {.beams = 181, .angle_step_rad = 1.5 * std::numbers::pi / 180}, world_T_scan, rng_, stamp_ns);
      if (gate_.add(motion)) {
        Keyframe keyframe;
        std::vector<BeamCode> codes(static_cast<std::size_t>(gate_.beams(scan)));
        gate_.encode(scan, {}, keyframe, codes);
        gate_.accept();
        feed_->add(keyframe, codes);
      }
      PoseRecord pose{.map_T_scan = motion.odom_T_current, .odom_T_scan = motion.odom_T_current};
      feed_->place(pose);
      keeper_->add(StampedPose{stamp_ns, motion.odom_T_current}, 0);
    }
  }

  template <class Holds>
  [[nodiscard]] static bool wait_until(const Holds& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!holds() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return holds();
  }
  /// Whether graph and file have gone over to that.
  [[nodiscard]] bool does(WorldUse use) const {
    const GraphHealth graph = feed_->health();
    const WorldReport file = keeper_->report();
    return !graph.is_going_over && !file.is_going_over && graph.is_localising == (use == WorldUse::kLocalise) &&
           file.is_read_only == graph.is_localising;
  }
  [[nodiscard]] bool go_over(WorldUse use) {
    use == WorldUse::kLocalise ? feed_->go_over(use) : keeper_->begin_mapping();
    return wait_until([&] { return does(use); });
  }
  void end() {
    keeper_->begin_end();
    ASSERT_TRUE(wait_until([&] { return !keeper_->is_ending(); }));
  }

  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "kept.world"; }
  [[nodiscard]] std::string content() const {
    std::ifstream in(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] static std::unique_ptr<StoredWorld> read(const std::filesystem::path& path) {
    WorldFile file;
    const FileFailure failed = file.open_to_read(path);
    EXPECT_FALSE(failed.any()) << failed.text;
    WorldReading reading = read_world(file, RobotParams{});
    EXPECT_NE(reading.world, nullptr) << reading.wrong;
    return std::move(reading.world);
  }
  /// The file has the graph's world: no keyframe more, none less, and each where the graph has it.
  void expect_as_in_graph() {
    const std::unique_ptr<StoredWorld> world = read(path());
    ASSERT_NE(world, nullptr);
    EXPECT_TRUE(feed_->look(std::chrono::seconds(60), [&](const SubmapGraph& graph, int) {
      ASSERT_EQ(world->store.size(), graph.mapped_keyframes());
      for (int i = 0; i < world->store.size(); ++i) {
        ASSERT_TRUE(test::is_same(world->store[i], graph.keyframes()[i])) << i;
        ASSERT_TRUE(std::ranges::equal(world->store.codes(i), graph.keyframes().codes(i))) << i;
      }
      ASSERT_EQ(world->submaps_in_file, graph.map().submaps.size());
      for (int i = 0; i < world->submaps_in_file; ++i) {
        EXPECT_TRUE(test::is_same(world->graph.pose(i), graph.graph().pose(i))) << i;
      }
      const std::span<const Constraint> constraints = world->graph.constraints();
      ASSERT_LE(constraints.size(), graph.graph().constraints().size()) << "of a path are more";
      for (std::size_t i = 0; i < constraints.size(); ++i) {
        const Constraint& each = graph.graph().constraints()[i];
        EXPECT_EQ(constraints[i].from, each.from) << i;
        EXPECT_EQ(constraints[i].to, each.to) << i;
        EXPECT_EQ(constraints[i].weight, each.weight) << i;
      }
    }));
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<GraphFeed> feed_;
  std::unique_ptr<WorldKeeper> keeper_;

 private:
  static constexpr std::int64_t kPeriod_ns = 200'000'000;

  KeyframeGate gate_{GraphParams{}};
  SimulatedScene scene_ = ring(18.0, 10.0);
  Rng rng_{1};
  std::vector<Pose2> way_ = around();
  std::int64_t scans_ = 0;
  Pose2 world_T_start_ = way_[1];
  Pose2 world_T_before_{};
};

TEST_F(KeptWorld, IsClosedWhereTheRobotOnlyFindsItsWayAndStaysTheSameToTheLastByte) {
  drive(200);
  ASSERT_TRUE(go_over(WorldUse::kLocalise));
  const std::string before = content();
  EXPECT_FALSE(std::filesystem::exists(path().string() + "-wal"));
  expect_as_in_graph();
  drive(100);
  EXPECT_EQ(feed_->health().place, WorldPlaceKnown::kSure);
  end();
  EXPECT_EQ(content(), before);
}

TEST_F(KeptWorld, IsOpenedAgainToMap) {
  drive(300);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(go_over(WorldUse::kLocalise));
    const std::int64_t before = feed_->health().keyframes;
    drive(60);
    EXPECT_EQ(feed_->health().keyframes, before);
    ASSERT_TRUE(go_over(WorldUse::kContinue));
    drive(60);
    EXPECT_EQ(feed_->health().place, WorldPlaceKnown::kSure) << i;
    EXPECT_GT(feed_->health().keyframes, before);
  }
  end();
  expect_as_in_graph();
  const std::unique_ptr<StoredWorld> world = read(path());
  EXPECT_EQ(world->sessions.size(), 3U);
  EXPECT_EQ(connected_submaps(world->graph, 0).size(), world->submaps.size()) << "all sessions are one map";
}

TEST_F(KeptWorld, OfADaemonThatLocalisedFromTheStartIsOpenedToMapToo) {
  drive(303);
  ASSERT_TRUE(wait_until([&] { return keeper_->report().keyframes == feed_->health().keyframes; }));
  keeper_.reset();  // as killed: the submap that had begun is in no submap of the file
  start({}, WorldUse::kLocalise);
  EXPECT_TRUE(does(WorldUse::kLocalise));
  ASSERT_TRUE(go_over(WorldUse::kContinue));
  drive(40);
  EXPECT_EQ(feed_->health().place, WorldPlaceKnown::kSure) << "where it was last";
  end();
  expect_as_in_graph();
  EXPECT_EQ(read(path())->sessions.size(), 2U);
}

TEST_F(KeptWorld, IsNotOpenedAgainWhereItIsAnotherByNow) {
  drive(120);
  ASSERT_TRUE(go_over(WorldUse::kLocalise));
  const auto refusal = [&] {
    keeper_->begin_mapping();
    EXPECT_TRUE(wait_until([&] { return !keeper_->report().is_going_over; }));
    EXPECT_TRUE(does(WorldUse::kLocalise));
    return keeper_->report().refused;
  };
  const std::filesystem::path kept = folder_.path() / "aside";
  std::filesystem::rename(path(), kept);
  EXPECT_THAT(refusal(), HasSubstr("it is not there any more"));
  EXPECT_FALSE(std::filesystem::exists(path())) << "none is made";
  WorldFile other;
  ASSERT_FALSE(other.open_to_write(path(), "1.2.3").any());
  EXPECT_THAT(refusal(), HasSubstr("in use by another program"));
  other.close();
  EXPECT_THAT(refusal(), HasSubstr("it was replaced or changed"));
  std::filesystem::rename(kept, path());
  ASSERT_FALSE(other.open_to_write(path(), "1.2.3").any());
  ASSERT_FALSE(other.database().run("UPDATE world SET revision = revision + 1").any());
  other.close();
  EXPECT_THAT(refusal(), HasSubstr("it was replaced or changed"));
  ASSERT_FALSE(other.open_to_write(path(), "1.2.3").any());
  ASSERT_FALSE(other.database().run("UPDATE world SET revision = revision - 1").any());
  other.close();
  EXPECT_TRUE(go_over(WorldUse::kContinue));
}

TEST_F(KeptWorld, IsClosedWhenItIsFull) {
  GraphParams params;
  params.submaps_max = 16;
  std::filesystem::remove(path());
  start(params, WorldUse::kContinue);
  drive(400);
  ASSERT_TRUE(wait_until([&] { return does(WorldUse::kLocalise); }));
  EXPECT_EQ(feed_->health().used, 1.0);
  expect_as_in_graph();
  const std::string before = content();
  end();
  start(params, WorldUse::kContinue);
  EXPECT_TRUE(does(WorldUse::kLocalise)) << "when it is gone on with, too";
  drive(4);
  end();
  EXPECT_EQ(content(), before);
}

/// Pools that the robot fills in three rounds.
class KeptWorldThatIsCrowded : public KeptWorld {
 protected:
  static constexpr int kRound_scans = 304;

  void SetUp() override { start(few_submaps(), WorldUse::kContinue); }
  static GraphParams few_submaps() {
    GraphParams params;
    params.submaps_max = 56;
    return params;
  }
  [[nodiscard]] int thinnings() {
    int thinnings = 0;
    EXPECT_TRUE(
        feed_->look(std::chrono::seconds(60), [&](const SubmapGraph& graph, int) { thinnings = graph.thinnings(); }));
    return thinnings;
  }
  [[nodiscard]] bool is_all_written() {
    return wait_until([&] { return keeper_->report().keyframes == feed_->health().keyframes; });
  }
};

TEST_F(KeptWorldThatIsCrowded, LosesWhatTheGraphLeavesOut) {
  for (int i = 0; i < 30; ++i) {
    drive(kRound_scans / 4);
    ASSERT_TRUE(is_all_written());
    const std::unique_ptr<StoredWorld> world = read(path());  // as after a power cut
    EXPECT_EQ(connected_submaps(world->graph, 0).size(), world->submaps.size()) << i;
  }
  EXPECT_GT(thinnings(), 1);
  EXPECT_FALSE(feed_->health().is_localising);
  end();
  expect_as_in_graph();
  const std::unique_ptr<StoredWorld> world = read(path());
  EXPECT_LT(world->submaps.size(), 50U);
  ASSERT_EQ(world->sessions.size(), 1U);
  EXPECT_EQ(world->sessions[0].odometry.front().stamp_ns, world->store[0].stamp_ns);
  EXPECT_LT(world->sessions[0].odometry.size(), 5U * kRound_scans) << "of " << 30 * kRound_scans / 4;
  WorldFile file;
  ASSERT_FALSE(file.open_to_read(path()).any());
  EXPECT_EQ(file.damage(), "");
}

TEST_F(KeptWorldThatIsCrowded, IsGoneOnWithAndClosedAndOpenedAsBefore) {
  drive(4 * kRound_scans);
  EXPECT_GT(thinnings(), 0);
  ASSERT_TRUE(is_all_written());
  keeper_.reset();  // as killed
  start(few_submaps(), WorldUse::kContinue);
  drive(40);
  EXPECT_EQ(feed_->health().place, WorldPlaceKnown::kSure) << "where it was last";
  ASSERT_TRUE(go_over(WorldUse::kLocalise));
  drive(60);
  ASSERT_TRUE(go_over(WorldUse::kContinue));
  drive(4 * kRound_scans);
  EXPECT_GT(thinnings(), 0);
  EXPECT_EQ(feed_->health().place, WorldPlaceKnown::kSure);
  end();
  expect_as_in_graph();
}

// As a daemon does that is started anew with a world that is nearly full.
TEST_F(KeptWorldThatIsCrowded, IsThinnedWhenItIsGoneOnWith) {
  start({}, WorldUse::kContinue);
  drive(3 * kRound_scans);
  end();
  const std::size_t before = read(path())->submaps.size();
  ASSERT_GT(before, 36U);
  start(few_submaps(), WorldUse::kContinue);
  EXPECT_LT(feed_->health().submaps, 30);
  EXPECT_TRUE(does(WorldUse::kContinue));
  drive(kRound_scans);
  EXPECT_EQ(feed_->health().place, WorldPlaceKnown::kSure);
  end();
  expect_as_in_graph();
  EXPECT_EQ(read(path())->sessions.size(), 2U);
}

TEST_F(KeptWorldThatIsCrowded, IsMadeAnewWhereItWasRemoved) {
  drive(4 * kRound_scans);
  EXPECT_GT(thinnings(), 0);
  ASSERT_TRUE(is_all_written());
  std::filesystem::remove(path());
  drive(3 * kRound_scans);
  end();
  expect_as_in_graph();
}

// Keyframes go to the file before the graph has them: those that come while it goes over are of no world.
TEST_F(KeptWorld, HasNoKeyframeThatTheGraphDidNotMap) {
  drive(120);
  const std::int64_t mapped = feed_->health().keyframes;
  const Keyframe keyframe{.stamp_ns = 1'000'000'000'000, .angle_step_rad = 0.01, .beams = 1};
  const std::vector<BeamCode> codes{100};
  keeper_->add(keyframe, codes);
  ASSERT_TRUE(wait_until([&] { return keeper_->report().keyframes == mapped + 1; }));
  ASSERT_TRUE(go_over(WorldUse::kLocalise));
  expect_as_in_graph();
}

}  // namespace
}  // namespace odoless
