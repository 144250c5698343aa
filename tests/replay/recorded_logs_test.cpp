// What users rely on, on recorded logs: matching without a prior, and mapping without odometry. One configuration for
// all: the one that is built in. Figures that an outside reference gives are bounds; the reference's own noise is part
// of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "config/robot_params.hpp"
#include "core/graph/keyframe_gate.hpp"
#include "core/graph/submap_graph.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "firmware/stages/sensor_stage.hpp"
#include "tests/support/data.hpp"
#include "tools/eval/ate.hpp"
#include "tools/eval/pairs.hpp"
#include "tools/eval/relations.hpp"
#include "tools/eval/report.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/summary.hpp"

namespace odoless {
namespace {

constexpr auto kQuiet = [](std::int64_t, std::int64_t, double) {};

struct MatchCase {
  const char* name;
  const char* log;
  const char* reference;
  int every;
  double gross_percent_max;
};

std::ostream& operator<<(std::ostream& out, const MatchCase& match_case) { return out << match_case.name; }

PairsResult match_and_compare(const std::filesystem::path& log, const std::filesystem::path& reference, int every) {
  const std::vector<MatchRow> rows = match_pairs(read_scan_log(log), RobotParams{}, {.every = every}, kQuiet);
  return evaluate_pairs(read_reference_poses(reference), rows, {});
}

class RecordedMatches : public ::testing::TestWithParam<MatchCase> {};

TEST_P(RecordedMatches, FailGrosslyNoMoreOftenThanPromised) {
  const MatchCase& match_case = GetParam();
  ODOLESS_DATA_FILE(log, match_case.log);
  ODOLESS_DATA_FILE(reference, match_case.reference);
  const PairsResult result = match_and_compare(log, reference, match_case.every);
  EXPECT_GT(result.used, 200U);
  EXPECT_LE(100.0 * static_cast<double>(result.gross) / static_cast<double>(result.used), match_case.gross_percent_max)
      << report(result).text;
}

INSTANTIATE_TEST_SUITE_P(
    Logs, RecordedMatches,
    ::testing::Values(MatchCase{"Fr079Every5", "fr079.clf.xz", "fr079-gmapping.traj.xz", 5, 1.0},
                      MatchCase{"Freiburg101", "freiburg-101-corrected.log.gz", "freiburg-101-corrected.log.gz", 1,
                                1.0},
                      MatchCase{"Belgioioso", "belgioioso-corrected.log.gz", "belgioioso-corrected.log.gz", 1, 2.0},
                      MatchCase{"Orebro", "orebro-corrected.log.gz", "orebro-corrected.log.gz", 1, 9.0}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(RecordedMatchesOfFr079, AreAsExactAsTheReferenceCanTell) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");
  ODOLESS_DATA_FILE(reference, "fr079-gmapping.traj.xz");
  const PairsResult result = match_and_compare(log, reference, 1);
  EXPECT_GT(result.used, 4700U);
  EXPECT_LE(result.errors.translation_m.root_mean_square, 0.033) << report(result).text;
  EXPECT_LE(to_deg(result.errors.rotation_rad.root_mean_square), 0.75);
  EXPECT_LE(static_cast<double>(result.gross) / static_cast<double>(result.used), 0.0005);
  EXPECT_LE(result.time_us.median, 2500.0);
}

std::vector<ReferencePose> as_reference(const std::vector<StampedPose>& trajectory) {
  std::vector<ReferencePose> poses;
  for (const StampedPose& stamped : trajectory) {
    poses.push_back({static_cast<double>(stamped.stamp_ns) * 1e-9, stamped.map_T_scan});
  }
  return poses;
}

TEST(RecordedMaps, OfFr079CloseTheirLoopsFasterThanRecordedInLittleMemory) {
  ODOLESS_DATA_FILE(log, "fr079.clf.xz");
  ODOLESS_DATA_FILE(relations, "fr079.relations.xz");
  const ResourceMeter meter;
  const ReplayResult result = replay(read_scan_log(log), RobotParams{}, {}, kQuiet);
  const double cpu_s = meter.cpu_s();
  const RelationsResult errors = evaluate_relations(read_relations(relations), as_reference(result.trajectory), {});
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_LE(errors.errors.translation_m.mean, 0.046) << report(errors).text;
  EXPECT_LE(to_deg(errors.errors.rotation_rad.mean), 0.5);
  EXPECT_GE(result.log_duration_s / cpu_s, 5.0);
  EXPECT_LT(ResourceMeter::peak_rss_bytes(), 100'000'000);
}

// Fast turns, a gap of 3 s and long corridors, which make one loop.
TEST(RecordedMaps, OfAcesKeepTheirHeadingThroughFastTurns) {
  ODOLESS_DATA_FILE(log, "aces.clf.xz");
  ODOLESS_DATA_FILE(relations, "aces.relations.xz");
  const ReplayResult result = replay(read_scan_log(log), RobotParams{}, {}, kQuiet);
  EXPECT_TRUE(std::all_of(result.trajectory.begin(), result.trajectory.end(),
                          [](const StampedPose& p) { return std::isfinite(p.map_T_scan.distance_m({})); }));
  const RelationsResult errors = evaluate_relations(read_relations(relations), as_reference(result.trajectory), {});
  EXPECT_LE(errors.errors.translation_m.mean, 0.042) << report(errors).text;
  EXPECT_LE(to_deg(errors.errors.rotation_rad.mean), 0.4);
}

/// The final trajectory that the pose graph makes of a log. The particle filter, which takes most of the time, says
/// nothing to it but where the map begins.
std::vector<ReferencePose> trajectory_without_filter(const ScanLog& log, const RobotParams& params) {
  SensorStage sensor(false, params.scan.beams_max);
  MatcherStage matcher(params, 1);
  KeyframeGate gate(params.graph);
  SubmapGraph graph(params.graph, params.limits, params.scan, 1);
  ScanFrame scan(params.scan);
  std::vector<StampedPose> odom;
  for (const LogScan& each : log.scans) {
    const RawScan raw = each.raw();
    if (sensor.process(raw, raw.stamp_ns, scan) != ScanVerdict::kAccepted) {
      continue;
    }
    const Motion motion = matcher.process(scan);
    odom.push_back({scan.stamp_ns(), motion.odom_T_current});
    if (!gate.add(motion)) {
      continue;
    }
    Keyframe keyframe;
    std::vector<BeamCode> codes(static_cast<std::size_t>(gate.beams(scan)));
    gate.encode(scan, {}, keyframe, codes);
    gate.accept();
    bool is_at_work = graph.add(keyframe, codes);
    while (is_at_work) {
      is_at_work = graph.work();
    }
  }
  graph.finish();
  return as_reference(graph.corrected(odom));
}

// 1.9 km through corridors that look alike, in an area of 250 m by 215 m.
TEST(RecordedMaps, OfKillianCourtCloseLoopsOfHundredsOfMetres) {
  ODOLESS_DATA_FILE(log, "mit-killian.clf.xz");
  ODOLESS_DATA_FILE(relations, "mit-killian.relations.xz");
  const std::vector<ReferencePose> trajectory = trajectory_without_filter(read_scan_log(log), RobotParams{});
  const RelationsResult errors = evaluate_relations(read_relations(relations), trajectory, {});
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_LE(errors.errors.translation_m.mean, 0.036) << report(errors).text;
  EXPECT_LE(to_deg(errors.errors.rotation_rad.mean), 0.37);
}

// Doubled or smeared walls make a map blacker than it should be: the handheld demo walks about in one room of 3 by 5 m,
// whose walls have 16 m, one or two cells thick.
TEST(RecordedMaps, OfAHandheldLaserAreClean) {
  ODOLESS_DATA_FILE(log, "ccny-handheld-demo.csv.xz");
  const ReplayResult result = replay(read_scan_log(log), RobotParams{}, {}, kQuiet);
  EXPECT_EQ(result.trajectory.size(), 360U);
  EXPECT_LE(result.poor_matches, 4);
  const auto occupied = std::count_if(result.map.occupancy_percent.begin(), result.map.occupancy_percent.end(),
                                      [](std::int8_t percent) { return percent >= 65; });
  EXPECT_GT(occupied, 250);
  EXPECT_LT(occupied, 900);
}

/// Of the matches of a log's scans, from the least on.
std::vector<double> sorted_fitness(const ScanLog& log) {
  const RobotParams params;
  SensorStage sensor(false, params.scan.beams_max);
  MatcherStage matcher(params, 1);
  ScanFrame scan(params.scan);
  std::vector<double> fitness;
  for (const LogScan& each : log.scans) {
    const RawScan raw = each.raw();
    if (sensor.process(raw, raw.stamp_ns, scan) == ScanVerdict::kAccepted) {
      fitness.push_back(matcher.process(scan).fitness);
    }
  }
  std::sort(fitness.begin(), fitness.end());
  return fitness;
}

// The laser turns for 67 ms in a hand that turns it by up to 56 deg/s.
TEST(RecordedMatchesOfAHandheldLaser, FitBetterWithTheTimesOfItsBeams) {
  ODOLESS_DATA_FILE(path, "ccny-handheld-demo.csv.xz");
  ScanLog log = read_scan_log(path);
  const std::vector<double> fitness = sorted_fitness(log);
  std::for_each(log.scans.begin(), log.scans.end(), [](LogScan& scan) { scan.beam_period_ns = 0; });
  const std::vector<double> without = sorted_fitness(log);
  ASSERT_EQ(fitness.size(), without.size());
  const std::size_t tenth = fitness.size() / 10;
  EXPECT_GT(fitness[tenth], 1.04 * without[tenth]);
  EXPECT_GT(fitness[fitness.size() / 2], without[fitness.size() / 2]);
}

// The robot drives its corridors with about 0.1 m per scan and never jumps; the corridors of the loop are straight and
// cross at right angles, so that a drift within a corridor would show as a heading off a multiple of a quarter turn.
TEST(RecordedMaps, OfDWingTrackEveryScan) {
  ODOLESS_DATA_FILE(log, "dwing-loop5.log.xz");
  const ReplayResult result = replay(read_scan_log(log), RobotParams{}, {}, kQuiet);
  ASSERT_EQ(result.trajectory.size(), 551U);
  double length_m = 0.0;
  for (std::size_t i = 1; i < result.trajectory.size(); ++i) {
    const double step_m = result.trajectory[i].map_T_scan.distance_m(result.trajectory[i - 1].map_T_scan);
    EXPECT_LT(step_m, 0.8) << "at scan " << i;
    length_m += step_m;
  }
  EXPECT_GT(length_m, 45.0);
  EXPECT_LT(length_m, 65.0);
  ODOLESS_DATA_FILE(with_odometry, "dwing-dpslam-with-odometry.tum.xz");
  const AteResult ate = evaluate_ate(read_reference_poses(with_odometry).poses, as_reference(result.trajectory), {});
  EXPECT_GT(ate.used, 500U);
  EXPECT_LE(ate.errors.translation_m.root_mean_square, 0.12) << report(ate).text;
}

}  // namespace
}  // namespace odoless
