// Rows of the fault matrix that are about what scans show, in simulated time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/rng.hpp"
#include "tests/faults/stream_run.hpp"
#include "tests/support/fault_matrix.hpp"
#include "tools/fault_campaign/faults.hpp"

namespace odoless::test {
namespace {

using campaign::FaultKind;
using campaign::ScanStream;
using campaign::SentScan;

constexpr float kNothing_m = std::numeric_limits<float>::infinity();

void see_nothing(SentScan& scan) { std::ranges::fill(scan.ranges_m, kNothing_m); }

/// The drive whose scans are changed so while the fault lasts.
FaultyDrive spoilt(FaultyDrive drive, const std::function<void(SentScan&)>& change) {
  drive.spoil = [drive, change](ScanStream& stream) { for_each_faulty(drive, stream, change); };
  return drive;
}

FaultyDrive with_fault(FaultyDrive drive, FaultKind kind, double severity) {
  campaign::Scenario scenario{.fault = {kind, drive.from_s, drive.until_s, severity}, .seed = drive.seed};
  drive.spoil = [scenario](ScanStream& stream) { campaign::apply_fault(scenario, stream); };
  return drive;
}

/// Of the same drive without a fault.
double nominal_rms_m() {
  static const double rms_m = play(drive_of("rooms.world")).rms_m;
  return rms_m;
}

TEST(FaultMatrix, Row10AnotherNumberOfBeamsAndAnotherRange) {
  const FaultyRun run = play(spoilt(drive_of("rooms.world"), [](SentScan& scan) { scan.ranges_m.resize(181); }));
  measured(10, "recover", run.recover_s, "s");
  measured(10, "error", run.final_error_m, "m");
  EXPECT_LE(run.recover_s, 1.0);
  EXPECT_LT(run.final_error_m, 0.15);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
  EXPECT_EQ(run.last.lrf.rejected, 0) << "a laser may do that";
}

TEST(FaultMatrix, Row11NoBeamReturns) {
  const FaultyDrive drive = spoilt(drive_of("rooms.world"), see_nothing);
  const FaultyRun run = play(drive);
  measured(11, "flag", run.flag_s / period_s(drive), "T");
  measured(11, "recover", run.recover_s, "s");
  EXPECT_LE(run.flag_s, 3.0 * period_s(drive));
  EXPECT_NE(run.reasons & kReasonBlind, 0U);
  EXPECT_EQ(run.maps_made, 0) << "the map was updated by what nobody saw";
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

TEST(FaultMatrix, Row12HalfOfTheBeamsAreBlind) {
  FaultyDrive drive = drive_of("rooms.world");
  const double nominal_m = nominal_rms_m();
  drive =
      spoilt(drive, [](SentScan& scan) { std::fill_n(scan.ranges_m.begin(), scan.ranges_m.size() / 2, kNothing_m); });
  const FaultyRun run = play(drive);
  measured(12, "error", run.rms_m / nominal_m, "times nominal");
  EXPECT_TRUE(run.rms_m <= 2.0 * nominal_m || std::isfinite(run.flag_s)) << run.rms_m << " m, nominal " << nominal_m;
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

TEST(FaultMatrix, Row13TheSameScanAgainAndAgain) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.spoil = [drive](ScanStream& stream) {
    std::vector<float> shown_m;
    for_each_faulty(drive, stream, [&](SentScan& scan) {
      shown_m = shown_m.empty() ? scan.ranges_m : shown_m;
      scan.ranges_m = shown_m;
    });
  };
  const FaultyRun run = play(drive);
  measured(13, "flag", run.flag_s / period_s(drive), "T");
  measured(13, "recover", run.recover_s, "s");
  EXPECT_LE(run.flag_s, 5.0 * period_s(drive));
  EXPECT_NE(run.reasons & kReasonStuck, 0U);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

// For as long as that lasts nobody knows how far the robot goes: what comes next is matched as after a gap.
TEST(FaultMatrix, Row13TheSameScanWithLessThanTheLasersNoise) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.until_s = 11.0;
  drive.duration_s = 24.0;
  drive.spoil = [drive](ScanStream& stream) {
    std::vector<float> shown_m;
    Rng rng(7);
    for_each_faulty(drive, stream, [&](SentScan& scan) {
      shown_m = shown_m.empty() ? scan.ranges_m : shown_m;
      std::ranges::transform(shown_m, scan.ranges_m.begin(),
                             [&](float range_m) { return range_m + static_cast<float>(0.002 * rng.normal()); });
    });
  };
  const FaultyRun run = play(drive);
  EXPECT_NE(run.reasons & kReasonStuck, 0U);
  EXPECT_LT(run.final_error_m, 0.3) << "5 m without that";
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

void expect_bounded(const char* what, const std::function<void(float&)>& change) {
  const FaultyDrive drive = drive_of("rooms.world");
  const FaultyRun run = play(spoilt(drive, [&](SentScan& scan) { std::ranges::for_each(scan.ranges_m, change); }));
  measured(14, what, run.rms_m, "m");
  EXPECT_TRUE(run.rms_m < 0.15 || std::isfinite(run.flag_s)) << what << ": " << run.rms_m << " m";
  EXPECT_EQ(run.wrong_and_ok_s, 0.0) << what;
}

TEST(FaultMatrix, Row14RangesAreTooLongByFiveCentimetresOrTwoPercent) {
  expect_bounded("error of 5 cm bias", [](float& range_m) { range_m += 0.05F; });
  expect_bounded("error of 2 % scale", [](float& range_m) { range_m *= 1.02F; });
}

TEST(FaultMatrix, Row15TenPercentOfTheBeamsAreSpikes) {
  FaultyDrive drive = drive_of("rooms.world");
  const double nominal_m = nominal_rms_m();
  drive = with_fault(drive, FaultKind::kCorrupt, 0.1);
  const FaultyRun run = play(drive);
  measured(15, "error", run.rms_m / nominal_m, "times nominal");
  EXPECT_LE(run.rms_m, 1.2 * nominal_m);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

TEST(FaultMatrix, Row24NothingInRange) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.from_s = 0.0;
  drive.until_s = drive.duration_s;
  drive.spoil = [&](ScanStream& stream) { for_each_faulty(drive, stream, see_nothing); };
  const FaultyRun from_the_start = play(drive);
  drive.from_s = 6.0;
  const FaultyRun later = play(drive);
  measured(24, "flag", later.flag_s / period_s(drive), "T");
  measured(24, "largest correction", later.largest_step_m, "m");
  EXPECT_GE(from_the_start.not_ok_share, 1.0 - 3.0 * period_s(drive) / drive.duration_s);
  EXPECT_EQ(from_the_start.largest_step_m, 0.0) << "nothing was seen, and the robot is somewhere else";
  EXPECT_LE(later.flag_s, 3.0 * period_s(drive));
  EXPECT_LE(later.largest_step_m, 1.5 * 0.5 * period_s(drive)) << "more than the robot's own speed";
}

/// Of the beams while the fault lasts, those that show something nearer than they should.
double share_hidden(const FaultyDrive& drive, const ScanStream& clean, ScanStream stream) {
  double hidden = 0.0;
  double beams = 0.0;
  auto before = clean.scans.begin() + static_cast<std::ptrdiff_t>(drive.from_s * drive.laser.rate_hz);
  for_each_faulty(drive, stream, [&](const SentScan& scan) {
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      hidden += scan.ranges_m[i] < before->ranges_m[i] ? 1.0 : 0.0;
      beams += 1.0;
    }
    ++before;
  });
  return hidden / beams;
}

TEST(FaultMatrix, Row27PeopleHideFortyPercentOfTheBeams) {
  constexpr double kPeople = 18.0;
  FaultyDrive drive = with_fault(drive_of("rooms.world"), FaultKind::kCrowd, kPeople);
  double hidden = 0.0;
  drive.spoil = [&hidden, drive](ScanStream& stream) {
    const ScanStream clean = stream;
    drive.spoil(stream);
    hidden = share_hidden(drive, clean, stream);
  };
  const FaultyRun run = play(drive);
  measured(27, "hidden", 100.0 * hidden, "% of the beams");
  measured(27, "error", run.rms_m / nominal_rms_m(), "times nominal");
  EXPECT_GT(hidden, 0.35);
  EXPECT_LE(run.rms_m, 1.5 * nominal_rms_m());
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

TEST(FaultMatrix, Row42NumbersThatAreNone) {
  constexpr std::array kStrange_m{std::numeric_limits<float>::quiet_NaN(),
                                  kNothing_m,
                                  -kNothing_m,
                                  -1.0F,
                                  -0.0F,
                                  std::numeric_limits<float>::denorm_min(),
                                  std::numeric_limits<float>::max()};
  const FaultyDrive drive = drive_of("rooms.world");
  Rng chance(1, 1);
  int index = 0;
  const FaultyRun run = play(spoilt(drive, [&](SentScan& scan) {
    const double share = ++index % 3 == 0 ? 1.0 : 0.3;  // of the beams: every third scan has none that is right
    for (float& range_m : scan.ranges_m) {
      range_m = chance.uniform() < share ? kStrange_m.at(chance.below(kStrange_m.size())) : range_m;
    }
  }));
  measured(42, "recover", run.recover_s, "s");
  measured(42, "error", run.final_error_m, "m");
  EXPECT_TRUE(run.is_finite);
  EXPECT_LT(run.final_error_m, 0.2);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

}  // namespace
}  // namespace odoless::test
