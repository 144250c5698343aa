// What `odoless calibrate sweep` tells of how long a laser takes for the beams of one scan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
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

/// A log of a laser that drives through rooms.world, with 180 of its beams.
std::filesystem::path drive(const test::TemporaryFolder& folder, const std::string& lrf, bool is_distorted) {
  const std::filesystem::path log = folder.path() / (lrf + ".clf");
  const auto rooms = std::filesystem::path(__FILE__).parent_path() / "../../tools/worlds/rooms.world";
  std::vector<std::string> arguments{"sim", rooms.string(), "--lrf", lrf, "--beams", "180", "--out", log.string()};
  if (is_distorted) {
    arguments.emplace_back("--distortion");
  }
  EXPECT_EQ(run(arguments).status, 0);
  return log;
}

/// The same scans with the last beam first, of a log whose lines are ROBOTLASER1.
std::filesystem::path reversed(const test::TemporaryFolder& folder, const std::filesystem::path& log) {
  LineReader lines(open_bytes(log), log.string());
  std::string text;
  std::string_view line;
  while (lines.next(line)) {
    std::istringstream words{std::string(line)};
    std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    if (fields.front() == "ROBOTLASER1") {
      std::reverse(fields.begin() + 9, fields.begin() + 9 + std::stoi(fields[8]));
    }
    for (const std::string& field : fields) {
      text += field + ' ';
    }
    text.back() = '\n';
  }
  return folder.file("reversed.clf", text);
}

nlohmann::json told_of(const std::filesystem::path& log) {
  const auto told = run({"calibrate", "sweep", log.string(), "--json"});
  EXPECT_EQ(told.status, 0) << told.err;
  return nlohmann::json::parse(told.out);
}

TEST(CalibrateSweep, TellsHowLongALaserThatTurnsTakes) {
  const test::TemporaryFolder folder;
  const auto told = told_of(drive(folder, "rplidar-a1", true));
  EXPECT_EQ(told["verdict"], "sweep");
  EXPECT_NEAR(told["sweep_ms"].get<double>(), 1000.0 / 5.5, 1.0);
  EXPECT_GT(told["better"].get<double>(), 1.1);
}

TEST(CalibrateSweep, TellsTheShareOfTheTurnInWhichALaserMeasuresEitherWayRound) {
  const test::TemporaryFolder folder;
  const std::filesystem::path log = drive(folder, "lms200", true);
  const auto told = run({"calibrate", "sweep", log.string()});
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("sweep: 100 ms: ")) << "180 deg of a turn that takes 200 ms";
  EXPECT_THAT(told.out, HasSubstr("[lrf.mount]\nsweep_ms = 100\n"));
  EXPECT_EQ(told_of(reversed(folder, log))["sweep_ms"], -100.0);
}

TEST(CalibrateSweep, TellsThatASweepIsShort) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(told_of(drive(folder, "lms200", false))["verdict"], "short");
}

TEST(CalibrateSweep, TellsThatTheSweepOfARecordedLaserIsShort) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");  // an LMS 291: 13 ms for a scan
  const auto told = told_of(log);
  EXPECT_EQ(told["verdict"], "short");
  EXPECT_EQ(told["sweep_ms"], 0.0);
}

TEST(CalibrateSweep, SaysWhatIsMissingWhereItCannotTell) {
  const test::TemporaryFolder folder;
  const std::filesystem::path log = drive(folder, "rplidar-a1", true);
  const auto stands = run({"calibrate", "sweep", log.string(), "--for-s", "3"});
  EXPECT_EQ(stands.status, 65);
  EXPECT_THAT(stands.out, ::testing::Not(HasSubstr("[lrf.mount]"))) << "nothing to be copied";
  EXPECT_THAT(stands.err, HasSubstr("30 or more scans in turns of 1.7 deg from scan to scan"));
  const std::filesystem::path fast = drive(folder, "lms111", true);
  const auto short_ = run({"calibrate", "sweep", fast.string(), "--for-s", "20"});
  EXPECT_EQ(short_.status, 65);
  EXPECT_THAT(short_.err, HasSubstr("faster turns"));
}

}  // namespace
}  // namespace odoless
