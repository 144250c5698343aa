#include "tools/log/scan_log.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>

#include "tests/support/data.hpp"
#include "tools/command/error.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/log/tilt_log.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kBeamStepRad = std::numbers::pi / 180.0;

ScanLog read_text(std::string_view text) {
  LineReader lines(view_bytes(text, "test.log"), "test.log");
  return read_scan_log(lines);
}

std::string error_of(std::string_view text) {
  try {
    static_cast<void>(read_text(text));
  } catch (const DataError& error) {
    EXPECT_EQ(error.exit_code(), 65);
    return error.what();
  }
  return "no error";
}

/// What of a text is wrong where only so much of it may be kept.
template <class Read>
std::string refusal_within(std::size_t kept_bytes, const std::string& text, const Read& read) {
  LineReader lines(view_bytes(text, "bomb"), "bomb", kept_bytes);
  try {
    static_cast<void>(read(lines));
  } catch (const DataError& error) {
    return error.what();
  }
  return "no error";
}

std::string flaser(int ranges, const std::string& tail = "0 0 0 0 0 0 12.5 host 0.1") {
  std::string text;
  for (int i = 0; i < ranges; ++i) {
    text += fmt::format(" {}.5", 1 + i % 7);
  }
  return fmt::format("FLASER {}{} {}\n", ranges, text, tail);
}

TEST(ScanLog, ReadsFlaserAndSkipsEveryOtherMessage) {
  const ScanLog log = read_text(
      "# comment\nPARAM a b 0 nohost 0\nODOM 1 2 3 0 0 0 1 h 1\n\nSYNC x\n"
      "FLASER 3 1.5 81.91 inf 1 2 3 4 5 6 10.25 host 0.1\nNEFF 4\n"
      "\t FLASER\t3  0 nan 2 1 2 3 4 5 6 10.5 host 0.1 \r\n");
  EXPECT_EQ(log.format, "CARMEN FLASER");
  EXPECT_TRUE(log.has_stamps);
  ASSERT_EQ(log.scans.size(), 2U);
  EXPECT_THAT(log.scans[0].ranges_m, ElementsAre(1.5F, 81.91F, std::numeric_limits<float>::infinity()));
  EXPECT_EQ(log.scans[0].stamp_ns, 10'250'000'000);
  EXPECT_EQ(log.scans[1].stamp_ns, 10'500'000'000);
  EXPECT_TRUE(std::isnan(log.scans[1].ranges_m[1]));
  EXPECT_GE(log.scans[0].ranges_m[1], log.scans[0].no_return_m);
}

TEST(ScanLog, FlaserSpreadsItsBeamsByTheirNumber) {
  const std::vector<std::pair<int, double>> steps{{180, 1.0}, {181, 1.0},  {360, 0.5}, {361, 0.5},
                                                  {91, 2.0},  {721, 0.25}, {2, 180.0}};
  for (const auto& [ranges, step_deg] : steps) {
    const ScanLog log = read_text(flaser(ranges));
    EXPECT_EQ(log.scans[0].start_angle_rad, static_cast<float>(-90 * kBeamStepRad)) << ranges;
    EXPECT_EQ(log.scans[0].angle_step_rad, static_cast<float>(step_deg * kBeamStepRad)) << ranges;
    EXPECT_EQ(log.scans[0].ranges_m.size(), static_cast<std::size_t>(ranges));
  }
}

TEST(ScanLog, ReadsRobotLaserWhoseGeometryChanges) {
  const ScanLog log = read_text(
      "ROBOTLASER1 0 -1.5 3.0 0.5 20 0.01 0 3 1 2 20 0 1 2 3 4 5 6 0 0 0.1 0.2 0.3 7.5 host 1\n"
      "ROBOTLASER1 0 -0.5 1.0 0.25 0 0.01 1 2 1 30 2 9 9 1 2 3 4 5 6 0 0 0.1 0.2 0.3 7.75 host 1\n");
  EXPECT_EQ(log.format, "CARMEN ROBOTLASER1");
  ASSERT_EQ(log.scans.size(), 2U);
  EXPECT_THAT(log.scans[0].ranges_m, ElementsAre(1, 2, 20));
  EXPECT_EQ(log.scans[0].start_angle_rad, -1.5);
  EXPECT_EQ(log.scans[0].angle_step_rad, 0.5);
  EXPECT_EQ(log.scans[0].no_return_m, 20.0F);
  EXPECT_THAT(log.scans[1].ranges_m, ElementsAre(1, 30));
  EXPECT_EQ(log.scans[1].angle_step_rad, 0.25);
  EXPECT_TRUE(std::isinf(log.scans[1].no_return_m)) << "a maximum of 0 says nothing";
  EXPECT_EQ(log.scans[1].stamp_ns, 7'750'000'000);
}

TEST(ScanLog, TakesEachScanOnceWhenTheLogHasItTwice) {
  EXPECT_EQ(read_text(flaser(3) + "ROBOTLASER1 0 -1 2 1 20 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 12.5 h 1\n").scans.size(),
            1U);
}

TEST(ScanLog, ReadsDpSlamWithoutStamps) {
  const ScanLog log = read_text("Odometry 1 2 3 \nLaser 3 1 8.19 2 \nOdometry 1 2 3\nLaser 3 1 2 3\n");
  EXPECT_EQ(log.format, "DP-SLAM");
  EXPECT_FALSE(log.has_stamps);
  ASSERT_EQ(log.scans.size(), 2U);
  EXPECT_EQ(log.scans[1].stamp_ns, 200'000'000);
  EXPECT_EQ(log.scans[0].angle_step_rad, static_cast<float>(90 * kBeamStepRad));
  EXPECT_EQ(log.scans[0].no_return_m, 8.0F);
}

TEST(ScanLog, ReadsCsvWithAndWithoutATrailingField) {
  const ScanLog log = read_text(
      "# t,angle_min,...\n1282836370.970876,-2.0,0.5,0,0.1,0.02,5.6,2,3.0,5.6\n"
      "1282836371.071704,-2.0,0.5,0,0.1,0.02,5.6,2,3.0,5.6,42\n"
      "1282836371.171704,-2.0,0.5,0,0.1,0.02,5.6,2,3.0,5.7,\n");
  EXPECT_EQ(log.format, "handheld CSV");
  ASSERT_EQ(log.scans.size(), 3U);
  EXPECT_EQ(log.scans[0].stamp_ns, 1'282'836'370'970'876'000) << "exact, which a double is not";
  EXPECT_EQ(log.scans[0].start_angle_rad, -2.0);
  EXPECT_EQ(log.scans[1].ranges_m[1], log.scans[1].no_return_m);
}

TEST(ScanLog, HasTheTimesOfBeamsWhereCsvTellsThem) {
  const ScanLog log = read_text(
      "1.0,-2.0,0.5,9.766e-05,0.1,0.02,5.6,2,3.0,5.6\n"
      "1.1,-2.0,0.5,0,0.1,0.02,5.6,2,3.0,5.6\n"
      "1.2,-2.0,0.5,-1,0.1,0.02,5.6,2,3.0,5.6\n");
  ASSERT_EQ(log.scans.size(), 3U);
  EXPECT_EQ(log.scans[0].raw().beam_period_ns, 97'660);
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    EXPECT_EQ(log.scans[i].beam_period_ns, 0) << "unknown, in scan " << i;
  }
}

TEST(ScanLog, CountsScansWhereStampsTellNothing) {
  for (const char* const tail : {"0 0 0 0 0 0", "0 0 0 0 0 0 0 host 0", "0 0 0 0 0 0 1.01893e+09 host 1"}) {
    const ScanLog log = read_text(flaser(3, tail) + flaser(3, tail) + flaser(3, tail));
    EXPECT_FALSE(log.has_stamps) << tail;
    EXPECT_EQ(log.scans[2].stamp_ns, 400'000'000) << tail;
  }
}

TEST(ScanLog, KeepsStampsThatGoBackwards) {
  const ScanLog log = read_text(flaser(3, "0 0 0 0 0 0 5 h 0") + flaser(3, "0 0 0 0 0 0 4 h 0"));
  EXPECT_TRUE(log.has_stamps);
  EXPECT_EQ(log.scans[1].stamp_ns, 4'000'000'000);
}

TEST(ScanLog, NamesTheLineAndWhatIsWrong) {
  const std::string good = flaser(3);
  EXPECT_THAT(error_of(good + "FLASER 3 1 2 0 0 0 0 0 0 13 host 1\n"),
              HasSubstr("test.log:2: 13 fields do not fit 3 ranges"));
  EXPECT_THAT(error_of(good + "FLASER 3 1 2 x 0 0 0 0 0 0 13 host 1\n"), HasSubstr("field 5 is 'x'"));
  EXPECT_THAT(error_of(good + "FLASER 3 1 2 3 0 0 0 0 0 0 soon host 1\n"), HasSubstr("a time stamp in seconds"));
  EXPECT_THAT(error_of(good + "FLASER 3 1 2 3 0 0 0 0 0 y 13 host 1\n"), HasSubstr("field 11 is 'y'"));
  EXPECT_THAT(error_of(good + "FLASER 3 1 2 3 0 0 0 0 0 0\n"), HasSubstr("no time stamp"));
  EXPECT_THAT(error_of("FLASER 3 1 2 3 0 0 0 0 0 0 12.\n"), HasSubstr("12 fields do not fit 3 ranges"));
}

TEST(ScanLog, RefusesWhatCannotBeRight) {
  for (const char* const text : {"FLASER",
                                 "FLASER -1 1",
                                 "FLASER 0 0 0 0 0 0 0 1 h 1",
                                 "FLASER 99999999999999999999999 1 2 3",
                                 "FLASER 4000000000 1 2 3",
                                 "FLASER 18446744073709551615 1",
                                 "ROBOTLASER1 0 0 0",
                                 "Laser",
                                 "Laser 3 1 2",
                                 "Laser 2 1 2 3",
                                 "Laser 1 1\nLaserx 1 1",
                                 "Laser 0",
                                 "1,2,3",
                                 "1,2,3,4,5,6,7,9999999999,1",
                                 "1,2,0,0,0,0,5,1,1",
                                 "1,nan,1,0,0,0,5,1,1",
                                 "1,2,1,0,0,0,-5,1,1",
                                 "1,2,1,0,0,0,nan,1,1",
                                 "1,2,1,0,0,0,5,1,1\nFLASER 1 1",
                                 "ROBOTLASER1 0 0 0 0 9 0 0 1 1 18446744073709551615 0 0 0 0 0 0 0 0 0 0 0 1 h 1",
                                 "ROBOTLASER1 0 0 0 0 9 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1"}) {
    EXPECT_THAT(error_of(text), HasSubstr("test.log:")) << text;
  }
}

TEST(ScanLog, RefusesAFileWithoutScans) {
  EXPECT_THAT(error_of(""), HasSubstr("there are no scans"));
  EXPECT_THAT(error_of("Odometry 1 2 3\n"), HasSubstr("there are no scans"));
  EXPECT_THAT(error_of(std::string("\0\x01\xff\xfe", 4)), HasSubstr("FLASER"));
}

TEST(ScanLog, RefusesAnEndlessLine) { EXPECT_THAT(error_of(std::string(3U << 20U, 'x')), HasSubstr("1 MiB")); }

TEST(ScanLog, SaysWhenTheFileIsMissing) {
  try {
    static_cast<void>(read_scan_log("/nonexistent/log"));
    FAIL();
  } catch (const UserError& error) {
    EXPECT_EQ(error.exit_code(), 66);
    EXPECT_THAT(error.what(), HasSubstr("/nonexistent/log"));
  }
  EXPECT_THROW(static_cast<void>(read_scan_log("/")), NoInputError);
}

struct RealLog {
  const char* file;
  const char* format;
  std::size_t scans;
  std::size_t beams;
  double start_deg;
  double step_deg;
  bool has_stamps;

  friend void PrintTo(const RealLog& log, std::ostream* out) { *out << log.file; }
};

class RealLogs : public ::testing::TestWithParam<RealLog> {};

TEST_P(RealLogs, AreReadWhole) {
  const RealLog& expected = GetParam();
  ODOLESS_DATA_FILE(path, expected.file);
  const ScanLog log = read_scan_log(path);
  EXPECT_EQ(log.format, expected.format);
  EXPECT_EQ(log.has_stamps, expected.has_stamps);
  ASSERT_EQ(log.scans.size(), expected.scans);
  for (const LogScan& scan : log.scans) {
    ASSERT_EQ(scan.ranges_m.size(), expected.beams);
  }
  EXPECT_NEAR(log.scans[0].start_angle_rad, expected.start_deg * kBeamStepRad, 1e-4);
  EXPECT_NEAR(log.scans[0].angle_step_rad, expected.step_deg * kBeamStepRad, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealLogs,
    ::testing::Values(RealLog{"fr079.clf.xz", "CARMEN FLASER", 4934, 360, -90, 0.5, true},
                      RealLog{"aces.clf.xz", "CARMEN FLASER", 7374, 180, -90, 1, true},
                      RealLog{"dwing-loop5.log.xz", "DP-SLAM", 551, 181, -90, 1, false},
                      RealLog{"ccny-handheld-demo.csv.xz", "handheld CSV", 360, 681, -119.5312, 0.3515624, true},
                      RealLog{"orebro-corrected.log.gz", "CARMEN FLASER", 237, 181, -90, 1, false},
                      RealLog{"belgioioso-corrected.log.gz", "CARMEN FLASER", 395, 361, -90, 0.5, false},
                      RealLog{"freiburg-101-corrected.log.gz", "CARMEN FLASER", 292, 360, -90, 0.5, true}),
    [](const auto& log) {
      const std::string name = log.param.file;
      return name.substr(0, name.find_first_of("-."));
    });

TEST(ScanLog, AByteOrderMarkCostsNoScan) {
  EXPECT_EQ(read_text("\xEF\xBB\xBF" + flaser(3) + "\n" + flaser(3) + "\n").scans.size(), 2U);
}

// A line of a few bytes, and packed of hardly any, becomes a scan of many.
TEST(ScanLog, KeepsNoMoreOfALogThanItMay) {
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  std::string scans;
  std::string poses;
  std::string rows;
  for (int i = 0; i < 40'000; ++i) {
    scans += "FLASER 1 1 0 0 0 0 0 0 1 h 1\n";
    poses += fmt::format("{} 1 2 3\n", i);
    rows += fmt::format("{0},{0},0,{0},0,1,0.1,0,0,1,1,1\n", i);
  }
  const auto as_log = [](LineReader& lines) { return read_scan_log(lines); };
  const auto as_poses = [](LineReader& lines) { return read_reference_poses(lines); };
  const auto as_rows = [](LineReader& lines) { return read_tilt_log(lines); };
  EXPECT_THAT(refusal_within(kMiB, scans, as_log), HasSubstr("takes more than 1 MiB of memory"));
  EXPECT_THAT(refusal_within(kMiB, scans, as_poses), HasSubstr("takes more than 1 MiB of memory"));
  EXPECT_THAT(refusal_within(kMiB, poses, as_poses), HasSubstr("takes more than 1 MiB of memory"));
  EXPECT_THAT(refusal_within(kMiB, rows, as_rows), HasSubstr("takes more than 1 MiB of memory"));
  EXPECT_EQ(refusal_within(8 * kMiB, scans, as_log), "no error");
  EXPECT_EQ(refusal_within(8 * kMiB, rows, as_rows), "no error");
}

}  // namespace
}  // namespace odoless
