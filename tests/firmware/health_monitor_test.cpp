#include "firmware/health/health_monitor.hpp"

#include <gtest/gtest.h>

#include <ostream>

#include "firmware/health/health_text.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kScanPeriod_ns = 25'000'000;
using test::kSecond;

/// What stages say that do well, for a test to spoil.
class HealthMonitorTest : public ::testing::Test {
 protected:
  HealthMonitorTest() {
    sensor_.open = true;
    sensor_.period_ns = kScanPeriod_ns;
    sensor_.last_scan_ns = now_ns_;
    matcher_.stage.scans = 100;
    matcher_.weak_information_1_m2 = 100.0;
    matcher_.strong_information_1_m2 = 200.0;
    filter_.stage.scans = 100;
    surroundings_.device_tried = false;
  }

  const HealthReport& update() { return monitor_.update(sensor_, matcher_, filter_, surroundings_, now_ns_); }

  /// The state, and why.
  void expect(HealthState state, std::uint32_t reasons) {
    const HealthReport& report = update();
    EXPECT_EQ(report.state, state) << state_sentence(report);
    EXPECT_EQ(report.reasons, reasons) << state_sentence(report);
  }

  HealthParams params_;
  HealthMonitor monitor_{params_};
  SensorReport sensor_;
  MatcherReport matcher_;
  FilterReport filter_;
  Surroundings surroundings_;
  std::int64_t now_ns_ = 1000 * kSecond;
};

TEST_F(HealthMonitorTest, NothingToComplainOfIsOk) { expect(HealthState::kOk, 0); }

TEST_F(HealthMonitorTest, ASweepThatWasAskedForIsNoHarmAsLongAsPosesCome) {
  sensor_.tilt = {.used = true, .level = false};
  expect(HealthState::kDegraded, kReasonNotLevel);
  sensor_.tilt.sweeps = true;
  for (int i = 0; i < 10; ++i) {
    now_ns_ += kSecond;
    sensor_.last_scan_ns = now_ns_;
    sensor_.source.accepted += 40;
    sensor_.tilt.held_back += 39;
    expect(HealthState::kOk, kReasonSweep);
  }
  for (int i = 0; i < 3; ++i) {  // it no longer passes the level
    now_ns_ += kSecond;
    sensor_.last_scan_ns = now_ns_;
    sensor_.source.accepted += 40;
    sensor_.tilt.held_back += 40;
    static_cast<void>(update());
  }
  expect(HealthState::kDegraded, kReasonNotLevel);
}

TEST_F(HealthMonitorTest, IsInitUntilTheFirstPose) {
  filter_.stage.scans = 0;
  expect(HealthState::kInit, 0);
}

TEST_F(HealthMonitorTest, ALaserThatFallsSilentIsSaidWithinTwoPeriodsAndAFaultAfterAWhile) {
  now_ns_ += kScanPeriod_ns * 3 / 2;
  expect(HealthState::kOk, 0);
  now_ns_ = sensor_.last_scan_ns + 2 * kScanPeriod_ns;
  expect(HealthState::kDegraded, kReasonNoScans);
  now_ns_ = sensor_.last_scan_ns + params_.fault_after_ns + 1;
  expect(HealthState::kFault, kReasonNoScans);
  sensor_.last_scan_ns = now_ns_;
  expect(HealthState::kOk, 0);
}

TEST_F(HealthMonitorTest, ALineThatIsLostIsSaidAtOnce) {
  sensor_.open = false;
  expect(HealthState::kDegraded, kReasonDeviceClosed);
}

TEST_F(HealthMonitorTest, ALaserThatWasNeverThereIsAFaultOnlyOnceItWasTried) {
  sensor_ = {};
  filter_.stage.scans = 0;
  expect(HealthState::kInit, 0);
  surroundings_.device_tried = true;
  expect(HealthState::kFault, kReasonDeviceClosed);
}

TEST_F(HealthMonitorTest, ALaserThatIsThereAndNeverSendsIsSaidAfterAWhile) {
  sensor_.last_scan_ns = sensor_.period_ns = 0;
  filter_.stage.scans = 0;
  expect(HealthState::kInit, 0);
  now_ns_ += params_.fault_after_ns;
  expect(HealthState::kInit, 0);
  now_ns_ += 1;
  expect(HealthState::kInit, kReasonNoScans);
}

TEST_F(HealthMonitorTest, BlindAndStuckScansDegrade) {
  sensor_.blind = true;
  expect(HealthState::kDegraded, kReasonBlind);
  sensor_.stuck = true;
  expect(HealthState::kDegraded, kReasonBlind | kReasonStuck);
}

TEST_F(HealthMonitorTest, OnePoorMatchIsNoReasonAndSomeInARowAre) {
  matcher_.poor_in_a_row = params_.poor_matches - 1;
  expect(HealthState::kOk, 0);
  matcher_.poor_in_a_row = params_.poor_matches;
  expect(HealthState::kDegraded, kReasonPoorMatch);
}

TEST_F(HealthMonitorTest, ASceneThatHoldsOnlyOneDirectionIsSaid) {
  matcher_.weak_information_1_m2 = 0.5 * params_.weak_information_1_m2;
  expect(HealthState::kDegraded, kReasonWeakDirection);
}

TEST_F(HealthMonitorTest, AFilterThatIsLostIsLost) {
  filter_.lost = true;
  expect(HealthState::kLost, kReasonDiverged);
}

TEST_F(HealthMonitorTest, AFilterThatDoubtsIsToBeUsedWithCare) {
  filter_.doubtful = true;
  expect(HealthState::kDegraded, kReasonDiverged);
}

TEST_F(HealthMonitorTest, AMapThatMayHaveDriftedDegradesThePoseThatIsRightInIt) {
  filter_.pose_probability = 0.99;
  surroundings_.graph = GraphHealth{.undrifted = 0.95};
  expect(HealthState::kOk, 0);
  EXPECT_NEAR(update().pose_probability, 0.94, 0.001);
  surroundings_.graph = GraphHealth{.undrifted = 0.5, .has_drifted = true};
  expect(HealthState::kDegraded, kReasonDrift);
  EXPECT_NEAR(update().pose_probability, 0.495, 0.001);
}

TEST_F(HealthMonitorTest, AStageThatIsSilentIsAFault) {
  surroundings_.stage_silent = true;
  expect(HealthState::kFault, kReasonStageSilent);
}

TEST_F(HealthMonitorTest, WhatDoesNotTouchThePoseLeavesItOk) {
  surroundings_.storage_error = 28;
  filter_.paused = true;
  surroundings_.cloud = CloudHealth{.refused = 1};
  expect(HealthState::kOk, kReasonStorage | kReasonPaused | kReasonCloudFull);
}

TEST_F(HealthMonitorTest, AFullPoseGraphIsToldOf) {
  surroundings_.graph = GraphHealth{.used = 0.99};
  expect(HealthState::kOk, 0U);
  surroundings_.graph = GraphHealth{.used = 1.0};
  expect(HealthState::kDegraded, kReasonMapFull);
  EXPECT_EQ(update().graph->used, 1.0);
}

TEST_F(HealthMonitorTest, PosesThatMayComeLateAreToBeUsedWithCare) {
  surroundings_.standing_reasons = kReasonNotRealTime;
  expect(HealthState::kDegraded, kReasonNotRealTime);
}

constexpr std::int64_t kBadScans_ns = 500'000'000;  // a process that was stopped for a moment is soon as good as before

/// A count, and the reason that it gives when it grows.
struct Growing {
  const char* name;
  HealthReason reason;
  void (*grow)(SensorReport&, MatcherReport&, FilterReport&, Surroundings&);
  std::int64_t memory_ns = HealthParams{}.deadline_memory_ns;

  friend void PrintTo(const Growing& growing, std::ostream* out) { *out << growing.name; }
};

class GrowingCount : public HealthMonitorTest, public ::testing::WithParamInterface<Growing> {};

TEST_P(GrowingCount, IsAReasonForAWhileAndLatchedForEver) {
  expect(HealthState::kOk, 0);
  GetParam().grow(sensor_, matcher_, filter_, surroundings_);
  EXPECT_EQ(update().reasons, GetParam().reason);
  now_ns_ += GetParam().memory_ns - 1;
  sensor_.last_scan_ns = now_ns_;
  EXPECT_EQ(update().reasons, GetParam().reason);
  now_ns_ += 1;
  EXPECT_EQ(update().reasons, 0U);
  EXPECT_EQ(update().latched_reasons, GetParam().reason);
}

INSTANTIATE_TEST_SUITE_P(
    Counts, GrowingCount,
    ::testing::Values(
        Growing{"Rejected", kReasonBadScans, [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.rejected; },
                kBadScans_ns},
        Growing{"Motions", kReasonBadMotions,
                [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.motions_refused; }},
        Growing{"Forged", kReasonNotAuthentic, [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.forged; }},
        Growing{"Replayed", kReasonNotAuthentic, [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.replayed; }},
        Growing{"Servo", kReasonBadTilt, [](auto& sensor, auto&, auto&, auto&) { ++sensor.tilt.refused; }},
        Growing{"Late", kReasonBadScans, [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.late; }, kBadScans_ns},
        Growing{"Dropped", kReasonOverload, [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.dropped; }},
        Growing{"Cut", kReasonOverload, [](auto&, auto&, auto& filter, auto&) { ++filter.updates_cut; }},
        Growing{"Records", kReasonOverload, [](auto&, auto&, auto&, auto& around) { ++around.records_dropped; }},
        Growing{"Deadline", kReasonDeadlineMissed,
                [](auto&, auto& matcher, auto&, auto&) { ++matcher.stage.deadline_misses; }},
        Growing{"Tiles", kReasonMapFull, [](auto&, auto&, auto& filter, auto&) { ++filter.refused_tiles; }},
        Growing{"Cloud", kReasonCloudFull,
                [](auto&, auto&, auto&, auto& around) { around.cloud = CloudHealth{.refused = 1}; }},
        Growing{"Publishing", kReasonPublishing, [](auto&, auto&, auto&, auto& around) { ++around.publish_errors; }},
        Growing{"Datagrams", kReasonDatagramsLost,
                [](auto& sensor, auto&, auto&, auto&) { ++sensor.source.datagrams_lost; }}),
    [](const auto& about) { return std::string(about.param.name); });

TEST(HealthText, SaysWhatTheStampsWereLike) {
  EXPECT_EQ(times_text({}), "scan period not known");
  EXPECT_EQ(times_text({.scans = 9, .period_s = 0.1}), "scan period 0.100 s estimated");
  EXPECT_EQ(times_text({.scans = 13'631, .out_of_order = 631, .gaps = 2, .longest_gap_s = 3.03, .period_s = 0.197}),
            "631 stamps out of order, 2 gaps of up to 3.0 s; scan period 0.197 s estimated");
}

TEST(HealthText, SaysWhyThePoseIsCorrectedAndWhichCorrectionsAreFar) {
  MapCorrection correction{.reference = 12, .query = 87, .loop_closures = 1, .moved = {0.3, -0.39, 0.05}};
  EXPECT_FALSE(is_far(correction));
  EXPECT_EQ(correction_text(correction),
            "the pose is corrected by 0.49 m and 2.9 deg: a loop closure between submaps 12 and 87");
  correction.loop_closures = 3;
  correction.moved.yaw_rad = -0.1;
  EXPECT_TRUE(is_far(correction));
  EXPECT_EQ(correction_text(correction),
            "the pose is corrected by 0.49 m and 5.7 deg: 3 loop closures, the last one between submaps 12 and 87");
  correction.cause = CorrectionCause::kFound;
  correction.moved = {6.0, 8.0, 0.0};
  EXPECT_TRUE(is_far(correction));
  EXPECT_EQ(correction_text(correction),
            "the pose is corrected by 10.00 m and 0.0 deg: the robot was found in the world, at submap 12");
}

TEST(HealthText, EveryReasonHasItsOwnWords) {
  std::string before;
  for (std::uint32_t reason = 1; reason <= kReasonDrift; reason <<= 1U) {
    const std::string text = reasons_text(reason);
    EXPECT_FALSE(text.empty()) << reason;
    EXPECT_NE(text, before);
    before = text;
  }
  EXPECT_EQ(reasons_text(0), "");
  EXPECT_EQ(reasons_text(kReasonNoScans | kReasonPaused), "no scans, mapping is paused");
}

}  // namespace
}  // namespace odoless
