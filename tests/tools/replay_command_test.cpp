#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/output/matches.hpp"
#include "tools/output/sha256.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;

std::string read(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

int lines(const std::filesystem::path& path) {
  const std::string text = read(path);
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

// A small room and a short way, so that a whole replay takes well under a second.
class Replay : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto world = folder_.file("room.world",
                                    "room 0 0  8 6\nbox 2 2.5  1 0.5\nbox 4.5 4  0.5 1\npillar 6 2.5 0.2\n"
                                    "speed 0.5\nturn_rate 60\ngo 1 1  7 1  7 5\n");
    const Outcome made = run({"sim", world.string(), "--out", log(), "--truth", truth(), "--seed", "3"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  [[nodiscard]] std::string log() const { return (folder_.path() / "room.log").string(); }
  [[nodiscard]] std::string truth() const { return (folder_.path() / "room.truth.tum").string(); }
  [[nodiscard]] std::filesystem::path out(const char* name) const { return folder_.path() / name; }

  test::TemporaryFolder folder_;
};

TEST_F(Replay, WritesEveryOutput) {
  const Outcome done = run({"replay", log(), "--out", out("a").string(), "--truth", truth()});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.err, "") << "no progress bar where there is no terminal";
  const auto summary = nlohmann::json::parse(read(out("a") / "summary.json"));
  const int scans = summary["scans"].get<int>();
  EXPECT_GT(scans, 50);
  for (const char* key : {"log_duration_s", "wall_s", "cpu_s", "realtime_factor", "peak_rss_bytes", "match_median_us",
                          "match_p99_us", "match_max_us", "poor_matches"}) {
    EXPECT_TRUE(summary[key].is_number()) << key;
  }
  EXPECT_EQ(summary["sha256"], sha256_of_file(out("a") / "trajectory.tum"));
  EXPECT_EQ(lines(out("a") / "trajectory.tum"), scans);
  EXPECT_EQ(lines(out("a") / "trajectory_online.tum"), scans);
  EXPECT_EQ(read_matches(out("a") / "matches.csv").size(), static_cast<std::size_t>(scans - 1));
  for (const char* name : {"map.pgm", "map.yaml", "map.png"}) {
    EXPECT_TRUE(std::filesystem::exists(out("a") / name)) << name;
  }
}

TEST_F(Replay, WritesMcapThatGivesTheSameTrajectoryAgain) {
  ASSERT_EQ(run({"replay", log(), "--out", out("a").string(), "--mcap"}).status, 0);
  ASSERT_EQ(run({"replay", log(), "--out", out("plain").string()}).status, 0);
  const Outcome again = run({"replay", (out("a") / "replay.mcap").string(), "--out", out("b").string()});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(read(out("a") / "trajectory.tum"), read(out("plain") / "trajectory.tum"));
  EXPECT_EQ(read(out("a") / "trajectory.tum"), read(out("b") / "trajectory.tum"));
  EXPECT_FALSE(std::filesystem::exists(out("plain") / "replay.mcap"));
}

TEST_F(Replay, FindsTheTruePath) {
  ASSERT_EQ(run({"replay", log(), "--out", out("a").string()}).status, 0);
  const Outcome ate = run({"eval", "ate", truth(), (out("a") / "trajectory.tum").string(), "--json"});
  ASSERT_EQ(ate.status, 0) << ate.err;
  EXPECT_LT(nlohmann::json::parse(ate.out)["translation_m"]["rmse"].get<double>(), 0.05) << ate.out;
}

TEST_F(Replay, GivesTheSameBytesAgainAlsoUnderLoad) {
  ASSERT_EQ(run({"replay", log(), "--out", out("a").string()}).status, 0);
  std::atomic<bool> over = false;
  std::vector<std::jthread> load;
  for (int i = 0; i < 4; ++i) {
    load.emplace_back([&over] {
      while (!over) {
      }
    });
  }
  const int status = run({"replay", log(), "--out", out("b").string()}).status;
  over = true;
  ASSERT_EQ(status, 0);
  for (const char* name : {"trajectory.tum", "trajectory_online.tum", "map.pgm", "map.png"}) {
    EXPECT_EQ(read(out("a") / name), read(out("b") / name)) << name;
  }
}

TEST_F(Replay, AnotherSeedGivesAnotherTrajectory) {
  ASSERT_EQ(run({"replay", log(), "--out", out("a").string()}).status, 0);
  ASSERT_EQ(run({"replay", log(), "--out", out("b").string(), "--seed", "2"}).status, 0);
  EXPECT_NE(read(out("a") / "trajectory.tum"), read(out("b") / "trajectory.tum"));
}

TEST_F(Replay, UsesEveryNthScanAndKeepsTheLogsIndices) {
  ASSERT_EQ(run({"match", log(), "--out", out("m").string(), "--every", "3"}).status, 0);
  const std::vector<MatchRow> rows = read_matches(out("m") / "matches.csv");
  ASSERT_GT(rows.size(), 10U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].reference_index, static_cast<int>(3 * i));
    EXPECT_EQ(rows[i].index, static_cast<int>(3 * i + 3));
    EXPECT_NEAR(rows[i].stamp_s - rows[i].reference_stamp_s, 0.6, 1e-6);
  }
}

TEST_F(Replay, MatchesArePairsOfTheTruth) {
  ASSERT_EQ(run({"match", log(), "--out", out("m").string(), "--every", "5"}).status, 0);
  const Outcome pairs = run({"eval", "pairs", truth(), (out("m") / "matches.csv").string(), "--json"});
  ASSERT_EQ(pairs.status, 0) << pairs.err;
  EXPECT_EQ(nlohmann::json::parse(pairs.out)["gross_failures"].get<int>(), 0) << pairs.out;
}

TEST_F(Replay, RefusesAWrongConfigurationByFileLineAndKey) {
  const auto config = folder_.file("bad.toml", "[matcher]\nscore_min = 3.0\nno_such_key = 1\n");
  const Outcome refused = run({"replay", log(), "--out", out("c").string(), "--config", config.string()});
  EXPECT_EQ(refused.status, 78);
  EXPECT_THAT(refused.err, HasSubstr("bad.toml:2"));
  EXPECT_THAT(refused.err, HasSubstr("matcher.score_min"));
  EXPECT_THAT(refused.err, HasSubstr("bad.toml:3"));
  EXPECT_FALSE(std::filesystem::exists(out("c"))) << "nothing is written for a job that cannot begin";
}

TEST_F(Replay, RefusesADamagedLogAndWritesNothing) {
  const auto cut = folder_.file("cut.log", read(log()).substr(0, 5000));
  const Outcome refused = run({"replay", cut.string(), "--out", out("d").string()});
  EXPECT_EQ(refused.status, 65);
  EXPECT_THAT(refused.err, HasSubstr("cut.log:"));
  EXPECT_FALSE(std::filesystem::exists(out("d")));
  EXPECT_EQ(run({"replay", (folder_.path() / "none").string(), "--out", out("d").string()}).status, 66);
}

TEST_F(Replay, OverwritesNoOtherRunsResultsUnlessForced) {
  for (const char* const command : {"replay", "match"}) {
    ASSERT_EQ(run({command, log(), "--out", out(command).string()}).status, 0);
    const std::string before = read(out(command) / "summary.json");
    const Outcome refused = run({command, log(), "--out", out(command).string()});
    EXPECT_EQ(refused.status, 73) << command;
    EXPECT_THAT(refused.err, HasSubstr("--force"));
    EXPECT_EQ(read(out(command) / "summary.json"), before);
    EXPECT_EQ(run({command, log(), "--out", out(command).string(), "--force"}).status, 0);
    EXPECT_NE(read(out(command) / "summary.json"), before) << "which has times";
  }
}

TEST_F(Replay, HasNoOptionForOdometry) {
  const Outcome help = run({"replay", "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, ::testing::Not(HasSubstr("odom ")));
  EXPECT_EQ(run({"replay", log(), "--out", out("e").string(), "--odometry", "yes"}).status, 64);
}

}  // namespace
}  // namespace odoless
