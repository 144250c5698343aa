// The world file: what is written is read back to the same bytes; what is no world, or damaged, is refused in words.
#include "firmware/world/world_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <utility>

#include "firmware/world/continued_world.hpp"
#include "firmware/world/world_blobs.hpp"
#include "firmware/world/world_mirror.hpp"
#include "firmware/world/world_reader.hpp"
#include "tests/firmware/world_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using test::is_same;
using test::keyframe_at;
using ::testing::HasSubstr;

RobotParams params() {
  RobotParams params;
  params.graph = test::small_graph();
  return params;
}

class World : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "a b?.world"; }

  void drive(SubmapGraph& graph, int from, int to) {
    for (int i = from; i < to; ++i) {
      const StoredKeyframe each = keyframe_at(i, rng_);
      odometry_.push_back(test::odometry_of(each));
      bool is_at_work = graph.add(each.keyframe, each.codes);
      while (is_at_work) {
        is_at_work = graph.work();
      }
    }
  }

  /// In one session, and closes it.
  void write(const SubmapGraph& graph) {
    WorldFile file;
    const FileFailure opened = file.open_to_write(path(), "1.2.3");
    ASSERT_FALSE(opened.any()) << opened.text;
    WorldPlace place;
    ASSERT_FALSE(file.begin({"2026-11-23T08:15:00Z", "1.2.3", "[scan]\n", 7}, place).any());
    WorldMirror mirror;
    append(file, place, mirror, graph);
    file.close();
  }

  void append(WorldFile& file, const WorldPlace& place, WorldMirror& mirror, const SubmapGraph& graph) {
    test::append(file, place, mirror, graph, std::exchange(odometry_, {}));
  }

  [[nodiscard]] WorldReading read() {
    WorldFile file;
    const FileFailure failed = file.open_to_read(path());
    return failed.any() ? WorldReading{nullptr, failed.text} : read_world(file, params());
  }

  void expect_same(const StoredWorld& world, const SubmapGraph& graph) {
    ASSERT_EQ(world.store.size(), graph.keyframes().size());
    for (int i = 0; i < world.store.size(); ++i) {
      EXPECT_TRUE(is_same(world.store[i], graph.keyframes()[i])) << i;
      EXPECT_TRUE(is_same(world.store.submap_T_scan(i), graph.keyframes().submap_T_scan(i))) << i;
      EXPECT_TRUE(std::ranges::equal(world.store.codes(i), graph.keyframes().codes(i))) << i;
    }
    ASSERT_EQ(world.submaps.size(), graph.submaps().size());
    for (int i = 0; i < world.graph.size(); ++i) {
      EXPECT_TRUE(is_same(world.graph.pose(i), graph.graph().pose(i))) << i;
    }
    ASSERT_EQ(world.graph.constraints().size(), graph.graph().constraints().size());
    for (std::size_t i = 0; i < world.graph.constraints().size(); ++i) {
      const Constraint& a = world.graph.constraints()[i];
      const Constraint& b = graph.graph().constraints()[i];
      EXPECT_TRUE(a.from == b.from && a.to == b.to && is_same(a.from_T_to, b.from_T_to) &&
                  a.covariance == b.covariance && a.is_loop == b.is_loop && a.weight == b.weight)
          << i;
    }
  }

  test::TemporaryFolder folder_;
  Rng rng_{3};
  std::vector<StampedPose> odometry_;
  SubmapGraph graph_{params().graph, RobotLimits{}, ScanParams{}, 1};
};

TEST_F(World, IsReadAsItWasWritten) {
  drive(graph_, 0, 83);
  graph_.finish();
  const std::vector<StampedPose> odometry = odometry_;
  write(graph_);
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  expect_same(*reading.world, graph_);
  ASSERT_EQ(reading.world->sessions.size(), 1U);
  const StoredSession& session = reading.world->sessions.front();
  EXPECT_EQ(session.about.configuration, "[scan]\n");
  EXPECT_EQ(session.about.seed, 7);
  ASSERT_EQ(session.odometry.size(), odometry.size());
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    EXPECT_EQ(session.odometry[i].stamp_ns, odometry[i].stamp_ns);
    EXPECT_TRUE(is_same(session.odometry[i].map_T_scan, odometry[i].map_T_scan));
  }
  EXPECT_FALSE(std::filesystem::exists(path().string() + "-wal")) << "a file that was closed is one file";
}

// Piece by piece, as the daemon writes: the same as all at once.
TEST_F(World, GrowsPieceByPiece) {
  WorldFile file;
  ASSERT_FALSE(file.open_to_write(path(), "1").any());
  WorldPlace place;
  ASSERT_FALSE(file.begin({}, place).any());
  WorldMirror mirror;
  for (int from = 0; from < 80; from += 7) {
    drive(graph_, from, from + 7);
    append(file, place, mirror, graph_);
  }
  graph_.finish();
  append(file, place, mirror, graph_);
  const std::int64_t revision = file.identity().revision;
  append(file, place, mirror, graph_);
  EXPECT_EQ(file.identity().revision, revision) << "nothing is new";
  const WorldReading reading = read();  // while the writer has it open
  ASSERT_TRUE(reading.world) << reading.wrong;
  EXPECT_EQ(reading.world->identity.uuid, file.identity().uuid);
  EXPECT_EQ(reading.world->identity.revision, revision);
  expect_same(*reading.world, graph_);
}

// As after a power cut: keyframes are there whose submap is not. The odometry makes it, to the same bytes.
TEST_F(World, MakesSubmapsOfKeyframesThatHaveNone) {
  drive(graph_, 0, 23);
  write(graph_);
  const std::size_t written = graph_.submaps().size();
  graph_.finish();
  ASSERT_GT(graph_.submaps().size(), written);
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  ASSERT_EQ(reading.world->submaps.size(), graph_.submaps().size());
  const int last = graph_.graph().size() - 1;
  EXPECT_EQ(reading.world->submaps.back().keyframes, graph_.submaps().back().keyframes);
  EXPECT_NEAR(reading.world->graph.pose(last).distance_m(graph_.graph().pose(last)), 0.0, 0.05);
  EXPECT_EQ(connected_submaps(reading.world->graph, 0).size(), graph_.submaps().size());
}

TEST_F(World, HasSessionsThatNothingJoinsYet) {
  drive(graph_, 0, 17);
  write(graph_);  // without its last submap, which the next session follows
  SubmapGraph second(params().graph, RobotLimits{}, ScanParams{}, 1);
  drive(second, 0, 31);
  second.finish();
  write(second);
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  ASSERT_EQ(reading.world->sessions.size(), 2U);
  graph_.finish();
  const StoredSession& first = reading.world->sessions.front();
  EXPECT_EQ(first.submaps, static_cast<int>(graph_.submaps().size()));
  const std::vector<int> joined = connected_submaps(reading.world->graph, reading.world->sessions[1].first_submap);
  EXPECT_EQ(joined.size(), second.submaps().size());
  const WorldPart part = part_of(*reading.world, joined);
  ASSERT_EQ(part.submaps.size(), second.submaps().size());
  for (int i = 0; i < part.graph.size(); ++i) {
    EXPECT_TRUE(is_same(part.graph.pose(i), second.graph().pose(i)));
  }
  EXPECT_EQ(part.graph.constraints().size(), second.graph().constraints().size());
}

// A run that is killed, and the next one, which has all of the world's numbers and adds its own.
TEST_F(World, IsGoneOnWith) {
  drive(graph_, 0, 23);
  write(graph_);  // without its last submap
  graph_.finish();
  WorldFile file;
  ASSERT_FALSE(file.open_to_write(path(), "1").any());
  ContinuedWorld continued;
  const FileFailure failed = continued.read(file, params(), WorldUse::kContinue);
  ASSERT_FALSE(failed.any()) << failed.text;
  ASSERT_NE(continued.stored(), nullptr);
  EXPECT_EQ(continued.stored()->submaps.size(), graph_.submaps().size());
  EXPECT_EQ(integer_of(file.database(), "SELECT count(*) FROM submap"),
            static_cast<std::int64_t>(graph_.submaps().size()))
      << "its last submap is made in the file too";
  SubmapGraph second(params().graph, RobotLimits{}, ScanParams{}, 1);
  ASSERT_TRUE(second.resume(continued.stored()->world()));
  odometry_.clear();
  drive(second, 0, 31);
  second.finish();
  EXPECT_GT(second.submaps().size(), graph_.submaps().size());
  WorldPlace place;
  ASSERT_FALSE(file.begin({}, place).any());
  WorldMirror mirror = continued.mirror();
  append(file, {.session = place.session}, mirror, second);
  file.close();
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  ASSERT_EQ(reading.world->sessions.size(), 2U);
  expect_same(*reading.world, second);
}

// As after a reset: a session before the last one has keyframes in no submap. Its last submap takes its place in the
// file.
TEST_F(World, IsGoneOnWithAfterASessionThatEndedInASubmap) {
  drive(graph_, 0, 17);
  write(graph_);
  SubmapGraph second(params().graph, RobotLimits{}, ScanParams{}, 1);
  drive(second, 0, 31);
  second.finish();
  write(second);
  const WorldReading before = read();
  ASSERT_TRUE(before.world) << before.wrong;
  WorldFile file;
  ASSERT_FALSE(file.open_to_write(path(), "1").any());
  ContinuedWorld continued;
  const FileFailure failed = continued.read(file, params(), WorldUse::kContinue);
  ASSERT_FALSE(failed.any()) << failed.text;
  SubmapGraph third(params().graph, RobotLimits{}, ScanParams{}, 1);
  ASSERT_TRUE(third.resume(continued.stored()->world()));
  odometry_.clear();
  drive(third, 0, 23);
  third.finish();
  WorldPlace place;
  ASSERT_FALSE(file.begin({}, place).any());
  WorldMirror mirror = continued.mirror();
  append(file, {.session = place.session}, mirror, third);
  file.close();
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  EXPECT_EQ(reading.world->sessions[0].submaps, before.world->sessions[0].submaps);
  EXPECT_EQ(static_cast<std::size_t>(reading.world->submaps_in_file), reading.world->submaps.size());
  expect_same(*reading.world, third);
}

TEST_F(World, SaysWhereTheRobotWasLast) {
  drive(graph_, 0, 40);
  graph_.finish();
  const std::vector<StampedPose> odometry = odometry_;
  write(graph_);
  SubmapGraph brief(params().graph, RobotLimits{}, ScanParams{}, 1);
  drive(brief, 0, 2);  // which ended where it began, and which nothing ties to the rest
  brief.finish();
  write(brief);
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  ASSERT_EQ(reading.world->sessions.back().submaps, 1);
  const std::optional<PlaceBySubmap> last = last_place(*reading.world);
  ASSERT_TRUE(last);
  const Pose2 map_T_scan = reading.world->graph.pose(last->submap) * last->submap_T_scan;
  EXPECT_LT(map_T_scan.distance_m(graph_.corrected(odometry).back().map_T_scan), 1e-6);
}

TEST_F(World, IsForOneWriterAtATime) {
  WorldFile first;
  WorldFile second;
  ASSERT_FALSE(first.open_to_write(path(), "1").any());
  const FileFailure failed = second.open_to_write(path(), "1");
  EXPECT_EQ(failed.error, EBUSY);
  EXPECT_THAT(failed.text, HasSubstr("in use"));
  first.close();
  EXPECT_FALSE(second.open_to_write(path(), "1").any());
  EXPECT_TRUE(second.is_in_place());
  std::filesystem::remove(path());
  EXPECT_FALSE(second.is_in_place());
}

TEST_F(World, IsCompactedInItsPlace) {
  drive(graph_, 0, 60);
  graph_.finish();
  write(graph_);
  WorldFile file;
  ASSERT_FALSE(file.open_to_write(path(), "1").any());
  const FileFailure failed = file.compact();
  ASSERT_FALSE(failed.any()) << failed.text;
  const WorldReading reading = read();
  ASSERT_TRUE(reading.world) << reading.wrong;
  expect_same(*reading.world, graph_);
  EXPECT_FALSE(std::filesystem::exists(path().string() + ".tmp"));
}

TEST_F(World, RefusesWhatIsNone) {
  WorldFile file;
  EXPECT_EQ(file.open_to_read(path()).error, ENOENT);
  folder_.file("a b?.world", "");
  EXPECT_THAT(file.open_to_read(path()).text, HasSubstr("empty"));
  folder_.file("a b?.world", std::string(5000, 'x'));
  EXPECT_THAT(file.open_to_read(path()).text, HasSubstr("no SQLite file"));
  EXPECT_THAT(file.open_to_write(path(), "1").text, HasSubstr("no SQLite file"));
  EXPECT_EQ(test::content_of(path()), std::string(5000, 'x')) << "it is left as it was";
}

/// Runs SQL on the file, whatever it is.
void alter(const std::filesystem::path& path, const std::string& sql) {
  if (!std::filesystem::exists(path)) {
    std::ofstream(path).flush();
  }
  Database database;
  ASSERT_FALSE(database.open(path, Database::Use::kWrite).any());
  const FileFailure failed = database.run(sql);
  ASSERT_FALSE(failed.any()) << failed.text;
}

TEST_F(World, RefusesAnotherProgramsFile) {
  alter(path(), "CREATE TABLE notes (text TEXT)");
  WorldFile file;
  const FileFailure failed = file.open_to_write(path(), "1");
  EXPECT_EQ(failed.error, EBADMSG);
  EXPECT_THAT(failed.text, HasSubstr("another program"));
}

TEST_F(World, RefusesAnotherVersionAndOtherTables) {
  drive(graph_, 0, 20);
  write(graph_);
  WorldFile file;
  alter(path(), "CREATE TRIGGER t AFTER INSERT ON keyframe BEGIN DELETE FROM submap; END");
  EXPECT_THAT(file.open_to_write(path(), "1").text, HasSubstr("tables"));
  alter(path(), "DROP TRIGGER t; PRAGMA user_version = 99");
  EXPECT_THAT(file.open_to_read(path()).text, HasSubstr("version 99"));
  EXPECT_THAT(file.open_to_write(path(), "1").text, HasSubstr("version 99"));
  alter(path(), "PRAGMA user_version = 1");
  EXPECT_FALSE(file.open_to_read(path()).any());
}

TEST_F(World, SaysWhatIsWrongInIt) {
  drive(graph_, 0, 40);
  graph_.finish();
  write(graph_);
  const std::string whole = test::content_of(path());
  const auto wrong_after = [&](const std::string& sql) {
    folder_.file("a b?.world", whole);
    alter(path(), sql);
    const WorldReading reading = read();
    EXPECT_FALSE(reading.world) << sql;
    return reading.wrong;
  };
  EXPECT_THAT(wrong_after("DELETE FROM keyframe WHERE id = 11"),
              HasSubstr("submap 3: 5 keyframes from 15 on, where 16 comes next"));
  EXPECT_THAT(wrong_after("UPDATE keyframe SET id = 99999999999 WHERE id = (SELECT max(id) FROM keyframe)"),
              HasSubstr("keyframe 99999999999"));
  EXPECT_THAT(wrong_after("UPDATE keyframe SET ranges = x'00' WHERE id = 3"), HasSubstr("keyframe 3"));
  EXPECT_THAT(wrong_after("UPDATE keyframe SET odom_x_m = 9e999 WHERE id = 3"), HasSubstr("keyframe 3"));
  EXPECT_THAT(wrong_after("UPDATE keyframe SET beams = 1000000"), HasSubstr("cannot be"));
  EXPECT_THAT(wrong_after("UPDATE submap SET keyframes = 1000 WHERE id = 2"), HasSubstr("submap 2"));
  EXPECT_THAT(wrong_after("UPDATE submap SET session = 4 WHERE id = 2"), HasSubstr("submap 2"));
  EXPECT_THAT(wrong_after("UPDATE submap_constraint SET to_submap = 99 WHERE id = 1"), HasSubstr("constraint 1"));
  EXPECT_THAT(wrong_after("UPDATE submap_constraint SET covariance = zeroblob(72)"), HasSubstr("constraint 0"));
  EXPECT_THAT(wrong_after("UPDATE odometry SET poses = x'0102'"), HasSubstr("odometry 1"));
  EXPECT_THAT(wrong_after("DELETE FROM world"), HasSubstr("which one it is"));
}

// Whatever bytes go bad: a world, or words; and never both halves of one.
TEST_F(World, OutlivesDamage) {
  drive(graph_, 0, 60);
  graph_.finish();
  write(graph_);
  const std::string whole = test::content_of(path());
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    std::string damaged = whole;
    const std::size_t at = static_cast<std::size_t>(rng_.below(static_cast<std::uint32_t>(whole.size())));
    for (std::size_t k = at; k < std::min(whole.size(), at + 64); ++k) {
      damaged[k] = static_cast<char>(rng_.below(256));
    }
    folder_.file("a b?.world", i % 4 == 0 ? damaged.substr(0, at) : damaged);
    const WorldReading reading = read();
    EXPECT_NE(reading.world == nullptr, reading.wrong.empty());
    refused += reading.world ? 0 : 1;
  }
  EXPECT_GT(refused, 50);
}

RC_GTEST_PROP(WorldBlobs, BeamsComeBack, (const std::vector<BeamCode>& codes)) {
  const std::vector<std::byte> packed = pack_beams(codes);
  std::vector<BeamCode> back(codes.size());
  RC_ASSERT(unpack_beams(packed, back));
  RC_ASSERT(back == codes);
  RC_ASSERT(packed.size() <= 2 * codes.size());
}

RC_GTEST_PROP(WorldBlobs, NoBytesAreTakenForMore, (const std::vector<std::uint8_t>& raw, std::uint8_t beams)) {
  std::vector<BeamCode> codes(beams);
  static_cast<void>(unpack_beams(std::as_bytes(std::span(raw)), codes));
  std::vector<StampedPose> poses;
  RC_ASSERT(!unpack_poses(std::as_bytes(std::span(raw)), poses) || raw.size() == 32 * poses.size());
}

}  // namespace
}  // namespace odoless
