// Rows of the fault matrix that are about the times of scans and the ways that robots go, in simulated time.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/faults/stream_run.hpp"
#include "tests/support/fault_matrix.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::test {
namespace {

using campaign::ScanStream;
using campaign::SentScan;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

TEST(FaultMatrix, Row01SilenceOfTenSecondsWhileTheRobotDrives) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.from_s = 20.0;  // it has a map to be found in
  drive.until_s = 30.0;
  drive.duration_s = 45.0;
  const double nominal_m = play(drive).final_error_m;
  drive.spoil = [drive](ScanStream& stream) {
    std::erase_if(stream.scans,
                  [&](const SentScan& scan) { return scan.true_s >= drive.from_s && scan.true_s < drive.until_s; });
  };
  const FaultyRun run = play(drive);
  measured(1, "flag", run.flag_s / period_s(drive), "T");
  measured(1, "recover", run.recover_s, "s");
  measured(1, "error", std::abs(run.final_error_m - nominal_m), "m");
  EXPECT_LE(run.flag_s, 2.0 * period_s(drive));
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
  EXPECT_LT(run.recover_s, 15.0);
  EXPECT_LE(std::abs(run.final_error_m - nominal_m), 0.10);
}

TEST(FaultMatrix, Row16RepeatedStamps) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.spoil = [drive](ScanStream& stream) {
    for (std::size_t i = 1; i < stream.scans.size(); ++i) {
      const bool is_faulty = stream.scans[i].true_s >= drive.from_s && stream.scans[i].true_s < drive.until_s;
      stream.scans[i].stamp_ns = is_faulty && i % 3 == 0 ? stream.scans[i - 1].stamp_ns : stream.scans[i].stamp_ns;
    }
  };
  const FaultyRun run = play(drive);
  measured(16, "counted", static_cast<double>(run.last.lrf.duplicate), "of 10");
  measured(16, "error", run.final_error_m, "m");
  EXPECT_EQ(run.last.lrf.duplicate, 10);
  EXPECT_TRUE(run.is_finite);
  EXPECT_LT(run.final_error_m, 0.15);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

TEST(FaultMatrix, Row17OutOfOrderByUpToFiveScans) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.spoil = [drive](ScanStream& stream) {
    std::int64_t behind = 0;
    for_each_faulty(drive, stream, [&](SentScan& scan) {
      const std::int64_t late_ns = static_cast<std::int64_t>(period_s(drive) * 1e9) * (behind++ % 6);
      scan.arrival_ns += late_ns + (late_ns > 0 ? 1'000'000 : 0);
    });
    std::ranges::stable_sort(stream.scans, {}, &SentScan::arrival_ns);
  };
  const FaultyRun run = play(drive);
  measured(17, "counted", static_cast<double>(run.last.lrf.out_of_order), "scans");
  measured(17, "error", run.final_error_m, "m");
  EXPECT_GE(run.last.lrf.out_of_order, 10);
  EXPECT_LT(run.largest_step_m, 0.5) << "more than the robot went between two scans that were taken";
  EXPECT_LT(run.final_error_m, 0.15);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

TEST(FaultMatrix, Row18LateScans) {
  for (const double late_s : {0.6, 3.0, 10.0}) {
    FaultyDrive drive = drive_of("rooms.world");
    drive.duration_s = 24.0;
    drive.spoil = [drive, late_s](ScanStream& stream) {
      for_each_faulty(drive, stream,
                      [&](SentScan& scan) { scan.arrival_ns += static_cast<std::int64_t>(late_s * 1e9); });
      std::ranges::stable_sort(stream.scans, {}, &SentScan::arrival_ns);
    };
    const FaultyRun run = play(drive);
    measured(18, fmt::format("flag of {} s", late_s).c_str(), run.flag_s / period_s(drive), "T");
    measured(18, fmt::format("recover of {} s", late_s).c_str(), run.recover_s, "s");
    EXPECT_EQ(run.last.lrf.late + run.last.lrf.out_of_order, 30) << "of " << late_s << " s: one was fused";
    EXPECT_LE(run.flag_s, 2.0 * period_s(drive));
    EXPECT_EQ(run.wrong_and_ok_s, 0.0);
  }
}

/// A passage of 30 m whose ends the laser does not see.
TEST(FaultMatrix, Row23FeaturelessCorridor) {
  FaultyDrive drive = drive_of("rooms.world");
  drive.world = parse_world("room 0 0  60 2.4\nspeed 0.5\ngo 15 1.2  45 1.2\n", "corridor");
  drive.laser.range_max_m = 8.0;
  drive.from_s = 0.2;  // from the first pose on
  drive.until_s = 30.0;
  drive.duration_s = 30.0;
  const FaultyRun run = play(drive);
  measured(23, "flag", run.flag_s / period_s(drive), "T");
  EXPECT_LE(run.flag_s, 5.0 * period_s(drive));
  EXPECT_NE(run.reasons & kReasonWeakDirection, 0U);
  const Pose2 off = run.final_off;
  measured(23, "error across", std::abs(off.y_m), "m");
  measured(23, "heading", std::abs(off.yaw_rad) * kDegPerRad, "deg");
  EXPECT_LE(std::abs(off.y_m), 0.05);
  EXPECT_LE(std::abs(off.yaw_rad) * kDegPerRad, 1.0);
}

/// One turn a second on the spot, a tenth of a turn from scan to scan.
TEST(FaultMatrix, Row28SpinAt360DegreesASecond) {
  FaultyDrive drive = drive_of("spin.world");
  for (Waypoint& waypoint : drive.world.waypoints) {
    waypoint.turn_rate_radps = 2.0 * std::numbers::pi;
  }
  const Path path(drive.world.waypoints);
  drive.duration_s = path.duration_s();
  drive.from_s = 0.5;
  drive.until_s = path.duration_s() - 1.5;
  const FaultyRun run = play(drive);
  measured(28, "heading", run.final_error_rad * kDegPerRad, "deg");
  measured(28, "error", run.final_error_m, "m");
  EXPECT_LE(run.final_error_rad * kDegPerRad, 1.0);
  EXPECT_LT(run.final_error_m, 0.1);
  EXPECT_EQ(run.wrong_and_ok_s, 0.0);
}

}  // namespace
}  // namespace odoless::test
