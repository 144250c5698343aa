// What every TiltSession owes, over both protocols and their emulated servos.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "drivers/tilt/tilt_history.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {

namespace {

using test::faults_of;
using test::kServoMs;
using test::kServoSecond;
using test::servo_params;
using test::ServoBench;

constexpr double kContractResolutionRad = 0.0016;  ///< 4096 steps per turn

class TiltContract : public ::testing::TestWithParam<test::TestedServo> {
 protected:
  [[nodiscard]] static TiltParams params(TiltCommand at_start = TiltCommand::kLevel) {
    TiltParams params = servo_params(GetParam());
    params.at_start = at_start;
    return params;
  }
};

void expect_samples_true(ServoBench& bench, double error_max_rad) {
  std::int64_t last_ns = 0;
  for (const TiltSample& sample : bench.heard().samples) {
    ASSERT_GT(sample.stamp_ns, last_ns);
    ASSERT_LE(sample.stamp_ns, sample.arrival_ns);
    ASSERT_NEAR(sample.angle_rad, bench.true_angle_rad(sample.stamp_ns), error_max_rad);
    last_ns = sample.stamp_ns;
  }
}

TEST_P(TiltContract, ComesToTheLevelPoseAndHoldsIt) {
  ServoBench bench(params());
  bench.reset();
  EXPECT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
  bench.run(2 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kLevel);
  EXPECT_NEAR(bench.angle_rad(), 0.0, kContractResolutionRad);
  EXPECT_EQ(bench.heard().count(TiltEventType::kReady), 1);
  EXPECT_EQ(bench.heard().events.size(), 1U);
  EXPECT_NEAR(static_cast<double>(bench.heard().samples.size()), 200.0, 120.0);
  EXPECT_EQ(bench.session().counters().rejected, 0U);
  EXPECT_EQ(bench.session().counters().samples, bench.heard().samples.size());
  expect_samples_true(bench, 0.02);
}

TEST_P(TiltContract, TurnsAnglesRoundAndMovesTheirZeroAsConfigured) {
  TiltParams inverted = params();
  inverted.inverted = true;
  inverted.level_angle_rad = 0.3;
  ServoBench bench(inverted);
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
  bench.run(500 * kServoMs);
  EXPECT_NEAR(bench.servo().angle_rad(), 0.3, kContractResolutionRad);
  expect_samples_true(bench, 0.02);
  bench.command(TiltCommand::kSweep);
  bench.run(3 * kServoSecond);
  expect_samples_true(bench, 0.02);
}

TEST_P(TiltContract, NodsBetweenTheEndsOfTheSweepWithinTheLimits) {
  TiltParams sweeping = params(TiltCommand::kSweep);
  sweeping.sweep_from_rad = -2.0;  // beyond the limit
  sweeping.limit_min_rad = -0.6;
  ServoBench bench(sweeping);
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kSweeping, 3 * kServoSecond), 0);
  const std::size_t first = bench.truth().size();
  bench.run(10 * kServoSecond);
  double low_rad = 0.0;
  double high_rad = 0.0;
  int turns = 0;
  double last_rad = 0.0;
  for (std::size_t i = first; i < bench.truth().size(); ++i) {
    const double angle_rad = bench.truth()[i].angle_rad;
    low_rad = std::min(low_rad, angle_rad);
    high_rad = std::max(high_rad, angle_rad);
    turns += last_rad <= 0.0 && angle_rad > 0.0 ? 1 : 0;
    last_rad = angle_rad;
  }
  EXPECT_NEAR(low_rad, -0.6, 0.02);
  EXPECT_GE(low_rad, -0.6 - kContractResolutionRad);
  EXPECT_NEAR(high_rad, params().sweep_to_rad, 0.02);
  EXPECT_GE(turns, 3);
  EXPECT_EQ(bench.session().counters().stalls, 0U);
  expect_samples_true(bench, 0.02);
}

TEST_P(TiltContract, TheAngleOfEachBeamIsFoundBetweenTheSamples) {
  ServoBench bench(params(TiltCommand::kSweep));
  bench.reset();
  bench.run(4 * kServoSecond);
  TiltHistory history(5 * params().sample_period_ns);
  for (const TiltSample& sample : bench.heard().samples) {
    EXPECT_TRUE(history.add(sample.stamp_ns, sample.angle_rad));
  }
  const std::int64_t end_ns = bench.heard().samples.back().stamp_ns;
  for (std::int64_t stamp_ns = end_ns - kServoSecond; stamp_ns < end_ns; stamp_ns += 777'777) {
    const Result<double> angle_rad = history.angle_rad(stamp_ns);
    ASSERT_TRUE(angle_rad.ok()) << describe(angle_rad.error());
    ASSERT_NEAR(angle_rad.value(), bench.true_angle_rad(stamp_ns), 0.005);
  }
}

TEST_P(TiltContract, VelocitiesAreThoseOfTheAngles) {
  TiltParams inverted = params(TiltCommand::kSweep);
  inverted.inverted = true;
  ServoBench bench(inverted);
  bench.reset();
  bench.run(4 * kServoSecond);
  const auto mean_radps = [&](std::int64_t from_ns) {
    constexpr std::int64_t kSpanNs = 20 * kServoMs;
    return (bench.true_angle_rad(from_ns + kSpanNs) - bench.true_angle_rad(from_ns)) / (kSpanNs * 1e-9);
  };
  int steady = 0;
  for (const TiltSample& sample : bench.heard().samples) {
    const double radps = mean_radps(sample.stamp_ns);
    if (std::abs(radps) > 0.1 && std::abs(mean_radps(sample.stamp_ns - 30 * kServoMs) - radps) < 1e-3) {
      ++steady;
      ASSERT_NEAR(sample.velocity_radps, radps, 0.03);
    }
  }
  EXPECT_GT(steady, 50);
}

TEST_P(TiltContract, CountsItsBringUpsAfterTheFirst) {
  ServoBench bench(params());
  bench.reset();
  EXPECT_EQ(bench.session().counters().restarts, 0U);
  bench.reset();
  bench.reset();
  EXPECT_EQ(bench.session().counters().restarts, 2U);
}

TEST_P(TiltContract, StopsWithin200MsAndStaysSo) {
  ServoBench bench(params(TiltCommand::kSweep));
  bench.reset();
  bench.run(2 * kServoSecond);
  bench.run_until([&] { return std::abs(bench.servo().velocity_radps()) > 0.9; }, 2 * kServoSecond);
  bench.command(TiltCommand::kStop);
  const std::int64_t took_ns = bench.run_until([&] { return bench.servo().velocity_radps() == 0.0; }, kServoSecond);
  EXPECT_GE(took_ns, 0);
  EXPECT_LE(took_ns, 200 * kServoMs);
  const double stopped_rad = bench.angle_rad();
  bench.run(3 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kStopped);
  EXPECT_NEAR(bench.angle_rad(), stopped_rad, 0.03);
  bench.command(TiltCommand::kLevel);
  EXPECT_GT(bench.run_until(TiltState::kLevel, 2 * kServoSecond), 0);
}

// As an owner does who tells it in every round.
TEST_P(TiltContract, ToldTheSameAgainAndAgainItSaysNoMore) {
  for (const TiltCommand command : {TiltCommand::kStop, TiltCommand::kLevel, TiltCommand::kSweep}) {
    std::size_t samples[2] = {};
    for (const bool tells_again : {false, true}) {
      ServoBench bench(params(command));
      bench.reset();
      bench.run(kServoSecond);
      const std::size_t before = bench.heard().samples.size();
      for (int i = 0; i < 2000; ++i) {
        if (tells_again) {
          bench.command(command);
        }
        bench.run(kServoMs / 2);
      }
      samples[tells_again ? 1 : 0] = bench.heard().samples.size() - before;
    }
    EXPECT_NEAR(static_cast<double>(samples[1]), static_cast<double>(samples[0]), 2.0)
        << kTiltCommandNames[static_cast<std::size_t>(command)];
  }
}

TEST_P(TiltContract, ToldToStopBeforeItIsThereItDoesNotMove) {
  ServoBench bench(params(TiltCommand::kStop));
  const double start_rad = bench.angle_rad();
  bench.reset();
  EXPECT_GT(bench.run_until(TiltState::kStopped, 3 * kServoSecond), 0);
  bench.run(kServoSecond);
  EXPECT_NEAR(bench.angle_rad(), start_rad, kContractResolutionRad);
  EXPECT_GT(bench.heard().samples.size(), 50U);
}

TEST_P(TiltContract, AStopHoldsThroughAReboot) {
  ServoBench bench(params(TiltCommand::kStop), faults_of("reboot@1"));
  bench.reset();
  bench.run(4 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kStopped);
  EXPECT_NEAR(bench.angle_rad(), 0.2, kContractResolutionRad);
}

TEST_P(TiltContract, AStalledServoIsToldAndStoppedAndTriedAgain) {
  ServoBench bench(params(TiltCommand::kSweep), faults_of("stall@2:1"));
  bench.reset();
  bench.run(2 * kServoSecond);
  ASSERT_EQ(bench.session().state(), TiltState::kSweeping);
  const std::int64_t took_ns = bench.run_until(TiltState::kFault, kServoSecond);
  EXPECT_GT(took_ns, 0);
  EXPECT_LE(took_ns, 200 * kServoMs);
  EXPECT_EQ(bench.heard().count(TiltEventType::kStalled), 1);
  EXPECT_EQ(bench.session().counters().stalls, 1U);
  const double jammed_rad = bench.angle_rad();
  bench.run(1500 * kServoMs);  // it is free again, and would go on if it had not been stopped
  EXPECT_EQ(bench.session().state(), TiltState::kFault);
  EXPECT_EQ(bench.servo().velocity_radps(), 0.0);
  EXPECT_NEAR(bench.angle_rad(), jammed_rad, 0.03);
  EXPECT_GT(bench.run_until(TiltState::kSweeping, 4 * kServoSecond), 0);
  const std::int64_t swept_ns =
      bench.run_until([&] { return std::abs(bench.angle_rad() - jammed_rad) > 0.5; }, 2 * kServoSecond);
  EXPECT_GE(swept_ns, 0) << "it moves again";
  EXPECT_EQ(bench.session().counters().stalls, 1U);
}

TEST_P(TiltContract, AServoThatStaysJammedIsTriedAgainAndAgainAndNeverSaysThatItMoves) {
  ServoBench bench(params(TiltCommand::kSweep), faults_of("stall@2"));
  bench.reset();
  bench.run(2 * kServoSecond);
  const double jammed_rad = bench.angle_rad();
  bench.run(10 * kServoSecond);
  EXPECT_GE(bench.session().counters().stalls, 3U);
  EXPECT_EQ(static_cast<std::uint64_t>(bench.heard().count(TiltEventType::kStalled)),
            bench.session().counters().stalls);
  EXPECT_LE(bench.session().counters().stalls, 6U) << "with a pause between";
  for (const TiltSample& sample : bench.heard().samples) {
    if (sample.stamp_ns > bench.now_ns() - 9 * kServoSecond) {
      ASSERT_NEAR(sample.angle_rad, jammed_rad, 0.02);
    }
  }
}

TEST_P(TiltContract, AServoThatFallsSilentIsToldAndComesBack) {
  ServoBench bench(params(), faults_of("silence@2:1"));
  bench.reset();
  bench.run(1900 * kServoMs);
  ASSERT_EQ(bench.session().state(), TiltState::kLevel);
  const std::int64_t took_ns = bench.run_until(TiltState::kBringUp, 2 * kServoSecond);
  EXPECT_GT(took_ns, 0);
  EXPECT_LE(took_ns, 450 * kServoMs);
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 1);
  bench.run(kServoSecond);
  EXPECT_GE(bench.run_until(TiltState::kLevel, kServoSecond), 0) << "back within a second";
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 1) << "silence is told once";
  EXPECT_EQ(bench.heard().count(TiltEventType::kReady), 2);
}

TEST_P(TiltContract, AServoThatIsSilentWhenItsLineIsOpenedAnewIsToldAnew) {
  ServoBench bench(params(), faults_of("silence@2:1"));
  bench.reset();
  bench.run(5 * kServoSecond);
  ASSERT_EQ(bench.session().state(), TiltState::kLevel);
  bench.to_session = [](std::vector<ServoFrame>& frames) { frames.clear(); };
  bench.reset();
  bench.run(3 * kServoSecond);
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 2);
}

TEST_P(TiltContract, AServoThatStartsAnewIsSetUpAnew) {
  ServoBench bench(params(), faults_of("reboot@2:0.3"));
  bench.reset();
  bench.run(2 * kServoSecond);
  EXPECT_GT(bench.run_until([&] { return bench.heard().count(TiltEventType::kReady) == 2; }, 3 * kServoSecond), 0);
  bench.run(kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kLevel);
  EXPECT_GE(bench.session().counters().restarts, 1U);
}

TEST_P(TiltContract, AServoThatReportsAFaultIsToldAndSwitchedOnAgain) {
  ServoBench bench(params(), faults_of("error=32@2:1"));
  bench.reset();
  bench.run(2500 * kServoMs);
  EXPECT_EQ(bench.session().state(), TiltState::kFault);
  ASSERT_GE(bench.heard().count(TiltEventType::kDeviceError), 1);
  const auto error = std::find_if(bench.heard().events.begin(), bench.heard().events.end(),
                                  [](const TiltEvent& event) { return event.type == TiltEventType::kDeviceError; });
  EXPECT_EQ(error->code, 32);
  EXPECT_GT(bench.run_until(TiltState::kLevel, 5 * kServoSecond), 0);
}

TEST_P(TiltContract, DamagedFramesAreRefusedAndNoWrongAngleIsPassedOn) {
  ServoBench bench(params(), faults_of("wrong-sum@2:0.04"));
  bench.reset();
  bench.run(4 * kServoSecond);
  EXPECT_GE(bench.session().counters().rejected, 1U);
  EXPECT_EQ(bench.session().state(), TiltState::kLevel);
  expect_samples_true(bench, 0.02);
}

TEST_P(TiltContract, AClockThatDriftsMattersNot) {
  ServoBench bench(params(TiltCommand::kSweep), faults_of("drift=1000@0"));
  bench.reset();
  bench.run(10 * kServoSecond);
  EXPECT_EQ(bench.session().counters().restarts, 0U);
  expect_samples_true(bench, 0.02);
}

TEST_P(TiltContract, AHostThatSleptFindsTheServoStoppedAndGoesOn) {
  ServoBench bench(params(TiltCommand::kSweep));
  bench.reset();
  bench.run(3 * kServoSecond);
  bench.host_asleep = true;
  bench.run(kServoSecond);
  EXPECT_EQ(bench.servo().velocity_radps(), 0.0) << "the servo's own watchdog stops it";
  bench.host_asleep = false;
  bench.run(3 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kSweeping);
  EXPECT_EQ(bench.session().counters().stalls, 0U);
}

TEST_P(TiltContract, AServoThatIsNotThereCostsNoBusyLoop) {
  ServoBench bench(params(), faults_of("silence@0"));
  bench.reset();
  for (int i = 0; i < 100; ++i) {
    bench.run(20 * kServoMs);
    ASSERT_GE(bench.session().next_deadline_ns(), bench.now_ns() - kServoMs) << "or its owner would spin";
  }
  EXPECT_EQ(bench.session().state(), TiltState::kBringUp);
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 1) << "silence is told once";
}

TEST_P(TiltContract, BeforeItsLineIsOpenItWantsNothing) {
  const auto session = make_tilt_session(params());
  EXPECT_TRUE(session->transmit().empty());
  EXPECT_EQ(session->next_deadline_ns(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(session->state(), TiltState::kBringUp);
}

/// Counts, and allocates nothing.
class SampleCounter final : public TiltSink {
 public:
  void on_angle(const TiltSample&) override { ++samples; }
  void on_event(const TiltEvent&) override { ++events; }
  int samples = 0;
  int events = 0;
};

TEST_P(TiltContract, NothingIsAllocatedAfterConstruction) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer has malloc; the released build runs this";
  }
  const std::unique_ptr<EmulatedServo> servo = ServoBench::make_servo(params(), faults_of("stall@1:1"));
  const auto session = make_tilt_session(params());
  SampleCounter counter;
  std::int64_t calls = 0;
  std::int64_t now_ns = 1000 * kServoSecond;
  session->reset(now_ns);
  for (int i = 0; i < 20'000; ++i, now_ns += kServoMs / 4) {
    servo->tick(now_ns);
    const std::vector<ServoFrame> replies = servo->take_output();
    const AllocationGuard guard;
    for (const ServoFrame& frame : replies) {
      session->receive(frame, now_ns, counter);
    }
    if (i == 10'000) {
      session->command(TiltCommand::kSweep, now_ns);
    }
    session->tick(now_ns, counter);
    auto bytes = session->transmit();
    calls += guard.calls();
    for (; !bytes.empty(); bytes = session->transmit()) {
      servo->receive(bytes, now_ns);
    }
  }
  EXPECT_EQ(calls, 0);
  EXPECT_GT(counter.samples, 200);
  EXPECT_GT(counter.events, 0);
}

INSTANTIATE_TEST_SUITE_P(Servos, TiltContract, ::testing::ValuesIn(test::kTestedServos),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace odoless
