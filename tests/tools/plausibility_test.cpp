// Logs whose numbers are of another unit, order or geometry than they should be.
#include "tools/log/plausibility.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "core/base/rng.hpp"
#include "tests/support/data.hpp"
#include "tests/support/stamp_faults.hpp"
#include "tools/log/straightness.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegreeRad = std::numbers::pi / 180.0;
constexpr std::int64_t kFirst_ns = 1'000'000'000'000;
constexpr std::int64_t kScanPeriod_ns = 200'000'000;

/// Range to the walls of a room from a point in it, or to the pillars that stand in it.
float range_in_room_m(double x_m, double y_m, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const double along_x_m = c > 0.0 ? (9.0 - x_m) / c : c < 0.0 ? -x_m / c : 1e9;
  const double along_y_m = s > 0.0 ? (6.0 - y_m) / s : s < 0.0 ? -y_m / s : 1e9;
  return static_cast<float>(std::min(along_x_m, along_y_m));
}

/// A drive through a room: 300 scans of 180 beams, 1 deg apart, without a fault.
ScanLog good_log() {
  Rng rng(5);
  ScanLog log{.format = "made for a test", .has_stamps = true, .scans = {}};
  for (int i = 0; i < 300; ++i) {
    LogScan scan{.stamp_ns = kFirst_ns + i * kScanPeriod_ns,
                 .start_angle_rad = -90.0 * kDegreeRad,
                 .angle_step_rad = kDegreeRad,
                 .no_return_m = 80.0F,
                 .ranges_m = {}};
    for (int beam = 0; beam < 180; ++beam) {
      const double angle_rad = (beam - 90 + 20.0 * std::sin(0.05 * i)) * kDegreeRad;
      scan.ranges_m.push_back(range_in_room_m(1.0 + 0.02 * i, 2.0 + std::sin(0.02 * i), angle_rad) +
                              static_cast<float>(0.01 * rng.normal()));
    }
    log.scans.push_back(scan);
  }
  return log;
}

template <class Change>
ScanLog changed(Change change) {
  ScanLog log = good_log();
  for (LogScan& scan : log.scans) {
    change(scan);
  }
  return log;
}

/// What a good log's scans are, within the precision of a float and a microsecond.
void expect_good(const ScanLog& log) {
  const ScanLog good = good_log();
  ASSERT_EQ(log.scans.size(), good.scans.size());
  for (std::size_t i = 0; i < good.scans.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(log.scans[i].stamp_ns - good.scans[i].stamp_ns), 0.0, 1000.0) << i;
    ASSERT_NEAR(log.scans[i].start_angle_rad, good.scans[i].start_angle_rad, 1e-6) << i;
    ASSERT_NEAR(log.scans[i].angle_step_rad, good.scans[i].angle_step_rad, 1e-8) << i;
    for (std::size_t beam = 0; beam < good.scans[i].ranges_m.size(); ++beam) {
      ASSERT_NEAR(log.scans[i].ranges_m[beam], good.scans[i].ranges_m[beam], 1e-5F);
    }
  }
}

TEST(Plausibility, LeavesAGoodLogAsItIs) {
  ScanLog log = good_log();
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, IsEmpty());
  expect_good(log);
}

TEST(Plausibility, CorrectsRangesInMillimetres) {
  ScanLog log = changed([](LogScan& scan) {
    for (float& range_m : scan.ranges_m) {
      range_m *= 1000.0F;
    }
  });
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, ElementsAre(HasSubstr("millimetres")));
  expect_good(log);
}

TEST(Plausibility, RefusesRangesOfNoKnownUnit) {
  for (const float unit : {100.0F, 0.001F, 1e6F}) {
    ScanLog log = changed([&](LogScan& scan) {
      for (float& range_m : scan.ranges_m) {
        range_m *= unit;
      }
    });
    const Plausibility found = make_plausible(log);
    EXPECT_FALSE(found.is_plausible()) << unit;
    EXPECT_THAT(found.right, HasSubstr("metres"));
  }
}

TEST(Plausibility, CorrectsAnglesInDegrees) {
  ScanLog log = changed([](LogScan& scan) {
    scan.start_angle_rad /= kDegreeRad;
    scan.angle_step_rad /= kDegreeRad;
  });
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, ElementsAre(HasSubstr("degrees")));
  expect_good(log);
}

TEST(Plausibility, RefusesBeamsOverMoreThanATurn) {
  ScanLog log = changed([](LogScan& scan) { scan.angle_step_rad *= 3.0; });
  const Plausibility found = make_plausible(log);
  EXPECT_FALSE(found.is_plausible());
  EXPECT_THAT(found.wrong, HasSubstr("more than a turn"));
}

TEST(Plausibility, RefusesAnAngleStepThatBendsWalls) {
  for (const double factor : {0.5, 2.0 / 3.0, 1.5, 2.0}) {
    ScanLog log = changed([&](LogScan& scan) { scan.angle_step_rad *= factor; });
    const Plausibility found = make_plausible(log);
    EXPECT_FALSE(found.is_plausible()) << factor;
    EXPECT_THAT(found.right, HasSubstr("about 1.000 deg")) << factor;
  }
}

struct StampUnit {
  const char* name;
  double factor;
};
std::ostream& operator<<(std::ostream& out, const StampUnit& unit) { return out << unit.name; }

class PlausibleStamps : public ::testing::TestWithParam<StampUnit> {};

TEST_P(PlausibleStamps, AreBroughtToSeconds) {
  ScanLog log = changed(
      [](LogScan& scan) { scan.stamp_ns = std::llround(static_cast<double>(scan.stamp_ns) * GetParam().factor); });
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, ElementsAre(HasSubstr(GetParam().name)));
  expect_good(log);
}

INSTANTIATE_TEST_SUITE_P(Units, PlausibleStamps,
                         ::testing::Values(StampUnit{"milliseconds", 1e3}, StampUnit{"microseconds", 1e6},
                                           StampUnit{"divided by 1000", 1e-3}),
                         [](const auto& tested) { return "Unit" + std::to_string(tested.index); });

TEST(Plausibility, SaysThatStampsWereNoSeconds) {
  ScanLog log = good_log();
  log.stamp_digits = 6;
  EXPECT_THAT(make_plausible(log).corrected, ElementsAre(HasSubstr("milliseconds")));
}

TEST(Plausibility, RefusesStampsOfNoLaser) {
  ScanLog slow = changed([](LogScan& scan) { scan.stamp_ns = (scan.stamp_ns - kFirst_ns) * 75; });
  EXPECT_THAT(make_plausible(slow).wrong, HasSubstr("15 s apart")) << "nor is it 15 ms: it may be a log of key scans";
}

TEST(Plausibility, RefusesALogThatRunsBackwards) {
  ScanLog log = good_log();
  std::reverse(log.scans.begin(), log.scans.end());
  EXPECT_THAT(make_plausible(log).wrong, HasSubstr("out of order"));
}

TEST(Plausibility, PutsScansInTheOrderOfTheirStampsWhereTheRangesAgree) {
  ScanLog log = good_log();
  Rng rng(6);
  for (std::size_t i = 0; i + 5 < log.scans.size(); i += 5) {
    std::swap(log.scans[i], log.scans[i + 1 + rng.below(4)]);
  }
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, ElementsAre(HasSubstr("order of their stamps")));
  expect_good(log);
}

TEST(Plausibility, KeepsTheOrderOfScansWhoseStampsWaver) {
  ScanLog log = good_log();
  std::vector<std::int64_t> stamps_ns;
  for (const LogScan& scan : log.scans) {
    stamps_ns.push_back(scan.stamp_ns);
  }
  stamps_ns = test::waver(stamps_ns, 1);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    log.scans[i].stamp_ns = stamps_ns[i];
  }
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, IsEmpty());
  EXPECT_EQ(log.scans[100].stamp_ns, stamps_ns[100]);
}

TEST(Plausibility, RefusesStampsOfOtherScans) {
  ScanLog log = good_log();
  Rng rng(7);
  for (std::size_t i = log.scans.size() - 1; i > 0; --i) {
    std::swap(log.scans[i].stamp_ns, log.scans[rng.below(static_cast<std::uint32_t>(i + 1))].stamp_ns);
  }
  EXPECT_THAT(make_plausible(log).wrong, HasSubstr("cannot be of these scans"));
}

struct RecordedLog {
  const char* file;
};
std::ostream& operator<<(std::ostream& out, const RecordedLog& log) { return out << log.file; }

class PlausibleLogs : public ::testing::TestWithParam<RecordedLog> {};

TEST_P(PlausibleLogs, AreLeftAsTheyAre) {
  ODOLESS_DATA_FILE(path, GetParam().file);
  ScanLog log = read_scan_log(path);
  const Plausibility found = make_plausible(log);
  EXPECT_TRUE(found.is_plausible()) << found.wrong;
  EXPECT_THAT(found.corrected, IsEmpty());
}

TEST_P(PlausibleLogs, HaveStraightWallsWithTheirOwnStepAlone) {
  ODOLESS_DATA_FILE(path, GetParam().file);
  const ScanLog log = read_scan_log(path);
  for (const double factor : {0.5, 2.0}) {
    ScanLog wrong = log;
    for (LogScan& scan : wrong.scans) {
      scan.angle_step_rad *= factor;
    }
    const double found = straight_step_factor(wrong);
    EXPECT_TRUE(factor < 1.0 ? found > 1.4 : found < 0.7) << "told " << factor << " times, found " << found;
  }
}

INSTANTIATE_TEST_SUITE_P(All, PlausibleLogs,
                         ::testing::Values(RecordedLog{"fr079.clf.xz"}, RecordedLog{"aces.clf.xz"},
                                           RecordedLog{"mit-killian.clf.xz"}, RecordedLog{"dwing-loop5.log.xz"},
                                           RecordedLog{"ccny-handheld-demo.csv.xz"}, RecordedLog{"urg04lx-room.csv.xz"},
                                           RecordedLog{"orebro-corrected.log.gz"},
                                           RecordedLog{"belgioioso-corrected.log.gz"},
                                           RecordedLog{"freiburg-101-corrected.log.gz"}),
                         [](const auto& tested) { return "Log" + std::to_string(tested.index); });

}  // namespace
}  // namespace odoless
