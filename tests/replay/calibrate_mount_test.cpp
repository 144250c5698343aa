// What `odoless calibrate mount` tells from 30 s of a recorded log, in which a robot drives and turns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/data.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {
namespace {

using test::run;
using ::testing::HasSubstr;

constexpr std::size_t kScans = 150;  // 30 s and a little more

/// The beginning of a CARMEN log, as a laser says it whose left and right are swapped, or beside which a mast stands.
std::string beginning_of(const std::filesystem::path& log, bool is_swapped, bool has_mast) {
  LineReader lines(open_bytes(log), log.string());
  std::string text;
  std::string_view line;
  for (std::size_t scans = 0; scans < kScans && lines.next(line);) {
    if (!line.starts_with("FLASER ")) {
      continue;
    }
    ++scans;
    std::istringstream words{std::string(line)};
    std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    const auto ranges = fields.begin() + 2;
    if (has_mast) {  // half a degree each from -90 deg on: 10 to 15 deg to the left
      std::fill(ranges + 200, ranges + 210, scans % 2 == 0 ? "0.41" : "0.42");
    }
    if (is_swapped) {
      std::reverse(ranges, ranges + std::stoi(fields[1]));
    }
    for (const std::string& field : fields) {
      text += field + ' ';
    }
    text.back() = '\n';
  }
  return text;
}

TEST(CalibrateMount, TellsTheFourCasesFrom30SecondsOfFreiburg) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");
  const test::TemporaryFolder folder;
  for (const bool hangs : {false, true}) {
    for (const bool is_mirrored : {false, true}) {
      const auto path = folder.file("part.clf", beginning_of(log, hangs != is_mirrored, false));
      const auto told = run({"calibrate", "mount", path.string(), "--for-s", "30", "--json", "--hangs",
                             hangs ? "upside-down" : "upright"});
      ASSERT_EQ(told.status, 0) << told.err;
      const auto json = nlohmann::json::parse(told.out);
      EXPECT_EQ(json["upside_down"], hangs);
      EXPECT_EQ(json["mirrored"], is_mirrored);
      EXPECT_GT(std::abs(json["agreement"].get<double>()), 0.9) << told.out;
      EXPECT_EQ(json["ignore"].size(), 0U) << told.out;
    }
  }
}

TEST(CalibrateMount, TellsASwappedLaserByTheWayOfTheFirstTurn) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");
  const test::TemporaryFolder folder;
  for (const bool is_swapped : {false, true}) {
    const auto path = folder.file("part.clf", beginning_of(log, is_swapped, false));
    const auto told = run({"calibrate", "mount", path.string(), "--first-turn", "right"});
    ASSERT_EQ(told.status, 0) << told.err;
    EXPECT_THAT(told.out, HasSubstr(is_swapped ? "left and right: swapped" : "left and right: as they should be"));
  }
}

TEST(CalibrateMount, FindsAMastThatTurnsWithTheRobot) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");
  const test::TemporaryFolder folder;
  for (const bool is_swapped : {false, true}) {  // told as the robot's bearings, however the laser hangs
    const auto path = folder.file("part.clf", beginning_of(log, is_swapped, true));
    const auto told = run({"calibrate", "mount", path.string(), "--json"});
    ASSERT_EQ(told.status, 0) << told.err;
    const auto ignore = nlohmann::json::parse(told.out)["ignore"];
    ASSERT_EQ(ignore.size(), 1U) << told.out;
    EXPECT_NEAR(ignore[0][0].get<double>(), 10.0, 1.5);
    EXPECT_NEAR(ignore[0][1].get<double>(), 15.0, 1.5);
    EXPECT_LE(ignore[0][0].get<double>(), 10.0);
    EXPECT_GE(ignore[0][1].get<double>(), 14.5);
  }
}

TEST(CalibrateMount, SaysThatItCannotTellWithoutATurn) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");
  const test::TemporaryFolder folder;
  const auto path = folder.file("part.clf", beginning_of(log, false, false));
  const auto told = run({"calibrate", "mount", path.string(), "--for-s", "2"});  // it stands
  EXPECT_EQ(told.status, 65);
  EXPECT_THAT(told.out, HasSubstr("left and right: cannot be told"));
  EXPECT_THAT(told.out, ::testing::Not(HasSubstr("[lrf.mount]"))) << "nothing to be copied";
}

}  // namespace
}  // namespace odoless
