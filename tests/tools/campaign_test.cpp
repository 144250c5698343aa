// The campaign's own work: which runs it draws, how it judges what the daemon says, and that a run can be had again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "tools/fault_campaign/gap_sweep.hpp"
#include "tools/fault_campaign/report.hpp"
#include "tools/fault_campaign/tally.hpp"

namespace odoless::campaign {
namespace {

constexpr double kRight_m = 0.1;
constexpr double kWrongBy_m = 3.0;

/// Ten observations a second, all scans, from `from_s` to `until_s`.
void show(Judge& judge, double from_s, double until_s, HealthState state, double error_m) {
  const int last = static_cast<int>(std::lround(until_s * 10.0));
  for (int i = static_cast<int>(std::lround(from_s * 10.0)); i < last; ++i) {
    judge.add({.time_s = 0.1 * i,
               .state = state,
               .error_m = error_m,
               .is_scan = true,
               .confidence = state == HealthState::kOk ? 0.99 : 0.02});
  }
}

TEST(CampaignJudge, CountsBeingSureAndWrongForMoreThanASecond) {
  Judge judge(0.0);
  show(judge, 0.0, 5.0, HealthState::kOk, kRight_m);
  show(judge, 5.0, 6.5, HealthState::kOk, kWrongBy_m);
  EXPECT_TRUE(judge.verdict().failed_silently());
  EXPECT_NEAR(judge.verdict().silent_s, 1.4, 1e-9);
  EXPECT_NEAR(judge.verdict().silent_from_s, 5.0, 1e-9);
}

TEST(CampaignJudge, LetsPassWhatIsSaidOrRightWithinASecond) {
  Judge judge(0.0);
  for (int i = 0; i < 20; ++i) {
    show(judge, 2.0 * i, 2.0 * i + 1.0, HealthState::kOk, kWrongBy_m);
    show(judge, 2.0 * i + 1.0, 2.0 * i + 1.2, i % 2 == 0 ? HealthState::kDegraded : HealthState::kOk,
         i % 2 == 0 ? kWrongBy_m : kRight_m);
    show(judge, 2.0 * i + 1.2, 2.0 * i + 2.0, HealthState::kLost, kWrongBy_m);
  }
  EXPECT_FALSE(judge.verdict().failed_silently());
}

TEST(CampaignJudge, TakesHalfAMetreOrFiveDegreesForWrong) {
  constexpr double kDeg = 3.14159265358979 / 180.0;
  EXPECT_FALSE(is_wrong(0.49, 4.9 * kDeg));
  EXPECT_TRUE(is_wrong(0.51, 0.0));
  EXPECT_TRUE(is_wrong(0.0, -5.1 * kDeg));
  EXPECT_TRUE(is_wrong(std::numeric_limits<double>::quiet_NaN(), 0.0));
}

TEST(CampaignJudge, TellsHowSoonItWasSaidAndWhenItWasGoodAgain) {
  Judge judge(5.0);
  show(judge, 0.0, 5.0, HealthState::kOk, kRight_m);
  show(judge, 5.0, 5.7, HealthState::kOk, kWrongBy_m);
  show(judge, 5.7, 8.0, HealthState::kLost, kWrongBy_m);
  show(judge, 8.0, 9.0, HealthState::kOk, 0.3);  // not for long enough
  show(judge, 9.0, 9.5, HealthState::kDegraded, 0.3);
  show(judge, 9.5, 12.0, HealthState::kOk, 0.3);
  show(judge, 12.0, 15.0, HealthState::kOk, kRight_m);
  const Verdict verdict = judge.verdict();
  ASSERT_EQ(verdict.said_after_s.size(), 1U);
  EXPECT_NEAR(verdict.said_after_s[0], 0.7, 1e-9);
  EXPECT_NEAR(verdict.recovered_after_s, 4.5, 1e-9);
  EXPECT_NEAR(verdict.settled_after_s, 7.0, 1e-9);
  EXPECT_EQ(verdict.all_scans(), 150);
  EXPECT_EQ(verdict.scans.at(static_cast<std::size_t>(HealthState::kLost)), 23);
  EXPECT_EQ(verdict.right_scans.at(static_cast<std::size_t>(HealthState::kOk)), 50 + 10 + 25 + 30);
}

TEST(CampaignJudge, HoldsNothingAgainstADaemonThatHasNoPoseYet) {
  Judge judge(0.0);
  show(judge, 0.0, 5.0, HealthState::kInit, kWrongBy_m);
  EXPECT_FALSE(judge.verdict().failed_silently());
  EXPECT_TRUE(judge.verdict().said_after_s.empty());
}

TEST(CampaignCalibration, CountsPosesInTheBinOfWhatWasSaid) {
  Calibration calibration;
  for (int i = 0; i < 10; ++i) {
    calibration.add(0.95, i < 8);
    calibration.add(0.1, i < 1);
  }
  calibration.add(1.0, true);
  calibration.add(0.0, false);
  EXPECT_EQ(calibration.bins[9].poses, 11);
  EXPECT_EQ(calibration.bins[9].right, 9);
  EXPECT_EQ(calibration.bins[1].poses, 10);
  EXPECT_NEAR(calibration.bins[1].share_right(), 0.1, 1e-12);
  EXPECT_EQ(calibration.bins[0].poses, 1);
  EXPECT_EQ(calibration.poses(), 22);
  // Off: 11 poses by (10.5 - 9) / 11, 10 by nothing, 1 by nothing.
  EXPECT_NEAR(calibration.error(), 1.5 / 22.0, 1e-12);
  Calibration both = calibration;
  both.add(calibration);
  EXPECT_EQ(both.poses(), 44);
  EXPECT_NEAR(both.error(), calibration.error(), 1e-12);
}

TEST(CampaignTally, KeepsKindsApart) {
  Judge bad(0.0);
  show(bad, 0.0, 5.0, HealthState::kOk, kWrongBy_m);
  Judge lost(0.0);
  show(lost, 0.0, 4.0, HealthState::kOk, kRight_m);
  show(lost, 4.0, 5.0, HealthState::kLost, kRight_m);
  RunResult silent{.verdict = bad.verdict()};
  silent.scenario.fault.kind = FaultKind::kSilence;
  const std::vector<RunResult> runs{silent, {.verdict = lost.verdict()}};
  EXPECT_EQ(tally_of(runs).silent_failures, 1);
  EXPECT_EQ(silent_failures(runs), 1);
  EXPECT_EQ(tally_of(runs, FaultKind::kSilence).silent_failures, 1);
  EXPECT_EQ(tally_of(runs, FaultKind::kNone).silent_failures, 0);
  EXPECT_NEAR(tally_of(runs, FaultKind::kNone).share_of(HealthState::kLost), 0.2, 1e-12);
  EXPECT_NEAR(tally_of(runs).share_right(HealthState::kOk), 40.0 / 90.0, 1e-12);
  EXPECT_NEAR(report_json(runs)["false_lost_share"].get<double>(), 0.2, 1e-12);
}

TEST(CampaignScenario, SixtyRunsHaveEveryKindAndSomeWithoutFault) {
  std::set<FaultKind> kinds;
  int fault_free = 0;
  for (int i = 0; i < 60; ++i) {
    const Scenario scenario = draw_scenario(1, i);
    kinds.insert(scenario.fault.kind);
    fault_free += scenario.fault.kind == FaultKind::kNone ? 1 : 0;
  }
  EXPECT_EQ(kinds.size(), fault_specs().size());
  EXPECT_EQ(fault_free, 12);
}

TEST(CampaignScenario, StaysWithinWhatIsSaid) {
  for (const FaultSpec& spec : fault_specs()) {
    EXPECT_EQ(&spec_of(spec.kind), &spec);
    for (int i = 0; i < 20; ++i) {
      const Scenario scenario = draw_scenario(3, i, spec.kind);
      const Fault& fault = scenario.fault;
      SCOPED_TRACE(describe(scenario));
      const double severity = spec.kind == FaultKind::kJumping ? std::abs(fault.severity) : fault.severity;
      EXPECT_GE(severity, spec.severity.min);
      EXPECT_LE(severity, spec.severity.max);
      EXPECT_LE(fault.start_s, fault.end_s);
      EXPECT_GE(scenario.duration_s, 20.0);
      if (fault.start_s > 0.0) {  // not the whole run: there is time to map before, and to find back after it
        EXPECT_GE(fault.start_s, 0.3 * scenario.duration_s);
        EXPECT_LE(fault.end_s, scenario.duration_s - 10.0);
      }
    }
  }
}

TEST(CampaignScenario, IsTheSameForTheSameSeedAndIndexAlone) {
  EXPECT_EQ(describe(draw_scenario(5, 17)), describe(draw_scenario(5, 17)));
  EXPECT_NE(describe(draw_scenario(5, 17)), describe(draw_scenario(6, 17)));
  EXPECT_NE(draw_scenario(5, 17).seed, draw_scenario(5, 18).seed);
}

/// A run of a few seconds, with a fault in its middle.
Scenario brief(FaultKind kind) {
  Scenario scenario = draw_scenario(1, 0, kind);
  scenario.world = "rooms";
  scenario.laser = "lms";
  scenario.path_start_s = 0.0;
  scenario.duration_s = 8.0;
  scenario.fault.start_s = 3.0;
  scenario.fault.end_s = 5.0;
  return scenario;
}

TEST(CampaignRun, GivesTheSameAgain) {
  Trace first;
  Trace again;
  static_cast<void>(play(brief(FaultKind::kCorrupt), &first));
  static_cast<void>(play(brief(FaultKind::kCorrupt), &again));
  EXPECT_GT(first.text.size(), 5000U);
  EXPECT_EQ(first.text, again.text);
}

// The same monitor as the daemon's: it must have seen the silence, and not only after the fact.
TEST(CampaignRun, SaysThatScansAreMissingWhileTheyAre) {
  Trace trace;
  const RunResult run = play(brief(FaultKind::kSilence), &trace);
  std::istringstream lines(trace.text);
  int silent_ticks = 0;
  for (std::string line; std::getline(lines, line);) {
    const double time_s = std::strtod(line.c_str(), nullptr);
    if (time_s > 3.45 && time_s < 4.95) {
      ++silent_ticks;
      EXPECT_EQ(line.find(",OK,"), std::string::npos) << line;
      EXPECT_NE(line.find("no scans"), std::string::npos) << line;
    }
  }
  EXPECT_EQ(silent_ticks, 15);
  EXPECT_EQ(run.verdict.all_scans(), 30);  // 40 less the 10 that are missing
}

// The laser odometry had the robot 1.8 and 4.2 m elsewhere by then: after a gap, and with ranges of the wrong scale.
TEST(CampaignRun, HasARobotThatWasFoundWhereItWasFound) {
  for (const auto& [seed, index] : {std::pair<std::uint64_t, int>{5, 47}, {3, 15}}) {
    const RunResult run = play(draw_scenario(seed, index));
    EXPECT_FALSE(run.verdict.failed_silently()) << seed << "/" << index << ": for " << run.verdict.silent_s << " s";
    EXPECT_LT(run.verdict.final_error_m, 0.3) << seed << "/" << index;
  }
}

/// The error that a trace has at that time, as it is written there.
double error_m_at(const Trace& trace, const std::string& time_s) {
  std::istringstream lines(trace.text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');) {
      fields.push_back(field);
    }
    if (fields[0] == time_s) {
      return std::strtod(fields[5].c_str(), nullptr);
    }
  }
  return -1.0;
}

TEST(CampaignRun, JudgesAPoseByItsScanAndAnOldOneByWhereTheRobotIsNow) {
  const Scenario scenario = brief(FaultKind::kSilence);
  Trace trace;
  static_cast<void>(play(scenario, &trace));
  const Drive drive(scenario);
  constexpr double kLast_s = 2.8;  // scan
  constexpr double kSlack_m = 0.1;
  const double way_m = drive.at(kLast_s).distance_m(drive.at(4.9));
  EXPECT_GT(way_m, 1.0);
  EXPECT_NEAR(error_m_at(trace, "4.900"), way_m, kSlack_m);
  EXPECT_LT(error_m_at(trace, "3.200"), kSlack_m);
}

TEST(CampaignGaps, SweepHasEveryLengthAtEveryTimeOfBothWorlds) {
  const GapSweep sweep(1);
  EXPECT_EQ(sweep.scenarios().size(), 192U);
  EXPECT_EQ(sweep.groups(), 24);
  std::set<std::string> distinct;
  for (const Scenario& scenario : sweep.scenarios()) {
    distinct.insert(fmt::format("{} {} {}", scenario.world, scenario.fault.start_s, scenario.fault.end_s));
    EXPECT_LE(scenario.duration_s, Path(load_world(scenario).waypoints).duration_s());
  }
  EXPECT_EQ(distinct.size(), 192U);
}

// Runs of one group share what is before the gap, and nothing after it.
TEST(CampaignGaps, AGroupGivesWhatEachOfItsRunsGivesAlone) {
  const GapSweep sweep(1);
  std::vector<Scenario> group{sweep.group(0)[0], sweep.group(0)[2]};
  for (Scenario& scenario : group) {
    scenario.duration_s = scenario.fault.end_s + 3.0;
  }
  const std::vector<GapResult> both = play_gaps(group);
  for (std::size_t i = 0; i < group.size(); ++i) {
    const GapResult alone = play_gaps({&group[i], 1}).front();
    EXPECT_EQ(alone.run.verdict.final_error_m, both[i].run.verdict.final_error_m);
    EXPECT_EQ(alone.run.verdict.silent_s, both[i].run.verdict.silent_s);
    EXPECT_EQ(alone.known_share, both[i].known_share);
    EXPECT_GT(alone.known_share, 0.0);
  }
}

TEST(CampaignReadme, HasARowForEveryFault) {
  std::ifstream in(std::filesystem::path(__FILE__).parent_path() / "../../tools/fault_campaign/README.md");
  const std::string readme((std::istreambuf_iterator<char>(in)), {});
  for (const FaultSpec& spec : fault_specs()) {
    const std::size_t at = readme.find(fmt::format("| {} |", spec.name));
    ASSERT_NE(at, std::string::npos) << spec.name;
    const std::string row = readme.substr(at, readme.find('\n', at) - at);
    if (spec.severity.max > 0.0) {
      EXPECT_NE(row.find(fmt::format("{:g} to {:g} {}", spec.severity.min, spec.severity.max, spec.severity_unit)),
                std::string::npos)
          << row;
    }
    if (spec.lasts_s.max > 0.0) {
      EXPECT_NE(row.find(fmt::format("{:g} to {:g} s", spec.lasts_s.min, spec.lasts_s.max)), std::string::npos) << row;
    }
    EXPECT_NE(row.find(spec.live ? "| live |" : "| log |"), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace odoless::campaign
