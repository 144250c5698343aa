// What is particular to Dynamixel servos, against an emulated one.
#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/tilt/dynamixel/control_table.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

TiltParams serial_params() { return test::servo_params(TiltDriver::kDynamixel); }

TEST(DynamixelSession, WritesKeptMemoryOnlyWhereItDiffers) {
  DynamixelDeviceOptions options;
  auto servo = std::make_unique<DynamixelDevice>(options, 1000 * kServoSecond);
  DynamixelDevice& device = *servo;
  ServoBench bench(serial_params(), std::move(servo));
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_EQ(device.kept_writes(), 3) << "return delay, mode, limits";
  EXPECT_EQ(device.get(dynamixel::kReturnDelay, 1), 0U);
  EXPECT_EQ(device.get(dynamixel::kOperatingMode, 1), 3U);
  EXPECT_EQ(device.get(dynamixel::kPositionMin, 4), 1536U) << "45 deg";
  EXPECT_EQ(device.get(dynamixel::kPositionMax, 4), 2560U);
  EXPECT_EQ(device.get(dynamixel::kBusWatchdog, 1), 15U) << "300 ms";
  EXPECT_EQ(device.get(dynamixel::kProfile + 4, 4), 44U) << "60 deg/s of 0.229 rev/min";
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_EQ(device.kept_writes(), 3);
  EXPECT_EQ(bench.session().state(), TiltState::kLevel);
}

// Another table, other units, and limits of speed and acceleration that X has not.
TEST(DynamixelSession, DrivesTheSeriesP) {
  TiltParams params = serial_params();
  params.at_start = TiltCommand::kSweep;
  DynamixelDeviceOptions options;
  options.model = "ph54-200-s500";
  ServoBench bench(params, std::make_unique<DynamixelDevice>(options, 1000 * kServoSecond));
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kSweeping, 2 * kServoSecond), 0);
  bench.run(8 * kServoSecond);
  EXPECT_EQ(bench.heard().events.size(), 1U) << "ready, and nothing else";
  EXPECT_GT(bench.heard().samples.size(), 300U);
  const auto by_angle = [](const TiltSample& a, const TiltSample& b) { return a.angle_rad < b.angle_rad; };
  const auto [low, high] = std::ranges::minmax_element(bench.heard().samples, by_angle);
  EXPECT_NEAR(low->angle_rad, params.sweep_from_rad, 0.02);
  EXPECT_NEAR(high->angle_rad, params.sweep_to_rad, 0.02);
  for (const TiltSample& sample : bench.heard().samples) {
    ASSERT_NEAR(sample.angle_rad, bench.true_angle_rad(sample.stamp_ns), 0.02);
  }
  const auto& device = bench.servo_as<DynamixelDevice>();
  EXPECT_EQ(device.get(dynamixel::kPositionMax, 4), 125'481U) << "45 deg of 1003846 steps a turn";
  EXPECT_EQ(device.get(dynamixel::kProfile + 4, 4), 1000U) << "60 deg/s of 0.01 rev/min";
  EXPECT_EQ(device.get(dynamixel::kProfile, 4), 6000U) << "600 deg/s2 of 1 rev/min2";
  bench.command(TiltCommand::kStop);
  EXPECT_GE(bench.run_until([&] { return bench.servo().velocity_radps() == 0.0; }, 200 * kServoMs), 0);
}

TEST(DynamixelSession, IsNoFasterThanAServosOwnLimitsAllow) {
  TiltParams params = serial_params();
  params.at_start = TiltCommand::kSweep;
  params.speed_radps = 20.0;
  params.acceleration_radps2 = 1000.0;
  DynamixelDeviceOptions options;
  options.model = "ph54-200-s500";
  ServoBench bench(params, std::make_unique<DynamixelDevice>(options, 1000 * kServoSecond));
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kSweeping, 2 * kServoSecond), 0);
  bench.run(2 * kServoSecond);
  EXPECT_EQ(bench.heard().events.size(), 1U) << "ready, and nothing is refused";
  EXPECT_EQ(bench.servo_as<DynamixelDevice>().get(dynamixel::kProfile + 4, 4), 2900U);
}

TEST(DynamixelSession, TablesAreKnownByTheModelsNumber) {
  EXPECT_EQ(dynamixel::control_table(1020)->first_lost, 64) << "XM430-W350";
  EXPECT_EQ(dynamixel::control_table(1999)->first_lost, 64) << "one that is new is of the series X";
  EXPECT_EQ(dynamixel::control_table(2000)->counts_per_turn, 607'500.0) << "PH42-020";
  EXPECT_EQ(dynamixel::control_table(54025)->counts_per_turn, 1'003'846.0) << "H54-200 (A)";
  EXPECT_FALSE(dynamixel::control_table(54024)) << "H54-200 without (A)";
  EXPECT_FALSE(dynamixel::control_table(350)) << "XL-320";
}

TEST(DynamixelSession, ComesUpWhateverItsLevelOfAnswersAndWithEchoes) {
  for (const std::uint8_t answers : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
    for (const bool echoes : {false, true}) {
      DynamixelDeviceOptions options;
      options.answers = answers;
      options.echoes = echoes;
      ServoBench bench(serial_params(), std::make_unique<DynamixelDevice>(options, 1000 * kServoSecond));
      bench.reset();
      EXPECT_GT(bench.run_until(TiltState::kLevel, 2 * kServoSecond), 0);
      EXPECT_EQ(bench.session().counters().wrong_echoes, 0U);
      EXPECT_EQ(bench.session().counters().echoes > 0, echoes);
    }
  }
}

TEST(DynamixelSession, AStopHoldsJustOutsideALimit) {
  TiltParams params = serial_params();
  params.limit_max_rad = 0.0;  // the level pose is at the limit
  DynamixelDeviceOptions options;
  options.start_rad = -0.2;
  options.sag_counts = 2.0;
  ServoBench bench(params, std::make_unique<DynamixelDevice>(options, 1000 * kServoSecond));
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
  bench.run(kServoSecond);
  const double resting_rad = bench.angle_rad();
  ASSERT_GT(resting_rad, params.limit_max_rad);
  bench.command(TiltCommand::kStop);
  bench.run(2 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kStopped);
  EXPECT_EQ(bench.heard().events.size(), 1U) << "it is ready, and nothing is wrong";
  EXPECT_NEAR(bench.angle_rad(), resting_rad, 0.005);
  const auto& device = bench.servo_as<DynamixelDevice>();
  EXPECT_EQ(device.get(dynamixel::kGoalPosition, 4), device.get(dynamixel::kPositionMax, 4));
  EXPECT_EQ(device.get(dynamixel::kProfile + 4, 4), 44U) << "it may move, and does so as ever";
}

TEST(DynamixelSession, AnEchoThatIsNotWhatWasSentIsToldAndTheAngleStaysRight) {
  DynamixelDeviceOptions options;
  options.echoes = true;
  ServoBench bench(serial_params(), std::make_unique<DynamixelDevice>(options, 1000 * kServoSecond));
  bench.reset();
  bench.run(kServoSecond);
  const dynamixel::PacketBytes other = dynamixel::encode(1, dynamixel::Instruction::kPing, {});
  bench.to_session = [&](std::vector<ServoFrame>& frames) {
    for (ServoFrame& frame : frames) {
      if (frame[7] != std::byte{0x55}) {
        frame.assign(std::as_bytes(other.span()).begin(), std::as_bytes(other.span()).end());
      }
    }
  };
  bench.run(30 * kServoMs);
  EXPECT_GE(bench.session().counters().wrong_echoes, 2U);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kRejected, Errc::kWrongEcho));
}

TEST(DynamixelSession, AnAnswerOfAnotherServoIsNotTaken) {
  ServoBench bench(serial_params());
  bench.reset();
  bench.run(kServoSecond);
  const std::size_t before = bench.heard().samples.size();
  std::vector<std::uint8_t> data(17, 0);
  const dynamixel::PacketBytes other = dynamixel::encode(2, dynamixel::Instruction::kStatus, data);
  bench.session().receive(std::as_bytes(other.span()), bench.now_ns(), bench.heard());
  EXPECT_EQ(bench.heard().samples.size(), before);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kRejected, Errc::kWrongEcho));
}

TEST(DynamixelSession, StampsAreTakenBackByTheTimeOnTheLine) {
  TiltParams params = serial_params();
  params.baud = 57'600;
  ServoBench bench(params);
  bench.reset();
  bench.run(kServoSecond);
  const TiltSample& sample = bench.heard().samples.back();
  // The emulated line is faster than its rate; the stamp is never before the request.
  EXPECT_LT(sample.stamp_ns, sample.arrival_ns);
  EXPECT_GE(sample.stamp_ns, sample.arrival_ns - 28 * 10 * kServoSecond / 57'600);
}

// One byte of the answers flipped, dropped, inserted or doubled, at every offset of a few rounds.
TEST(DynamixelSession, ADamagedByteCostsAtMostOneAngle) {
  for (int damage = 0; damage < 4; ++damage) {
    for (int offset = 0; offset < 90; ++offset) {
      ServoBench bench(serial_params());
      bench.reset();
      bench.run(600 * kServoMs);
      const std::size_t before = bench.heard().samples.size();
      int at = offset;
      bench.to_session = [&](std::vector<ServoFrame>& frames) {
        for (ServoFrame& frame : frames) {
          const auto size = static_cast<int>(frame.size());
          if (at >= 0 && at < size) {
            const auto byte = frame.begin() + at;
            if (damage == 0) {
              *byte ^= std::byte{0x21};
            } else if (damage == 1) {
              frame.erase(byte);
            } else {
              frame.insert(byte, damage == 2 ? std::byte{0x7E} : *byte);
            }
          }
          at = at < 0 ? at : at - size;
        }
      };
      bench.run(300 * kServoMs);
      // A lost answer costs the wait for it, here 5 periods.
      EXPECT_GE(bench.heard().samples.size(), before + 24) << damage << " at " << offset;
      EXPECT_EQ(bench.session().counters().restarts, 0U);
      for (const TiltSample& sample : bench.heard().samples) {
        ASSERT_NEAR(sample.angle_rad, bench.true_angle_rad(sample.stamp_ns), 0.02);
      }
    }
  }
}

TEST(DynamixelSession, AnySplitOfTheBytesGivesTheSame) {
  const auto samples = [](std::size_t piece) {
    ServoBench bench(serial_params());
    bench.to_session = [&](std::vector<ServoFrame>& frames) {
      std::vector<ServoFrame> pieces;
      for (const ServoFrame& frame : frames) {
        for (std::size_t at = 0; at < frame.size(); at += piece) {
          pieces.emplace_back(frame.begin() + static_cast<std::ptrdiff_t>(at),
                              frame.begin() + static_cast<std::ptrdiff_t>(std::min(at + piece, frame.size())));
        }
      }
      frames = pieces;
    };
    bench.reset();
    bench.run(kServoSecond);
    std::vector<double> angles_rad;
    for (const TiltSample& sample : bench.heard().samples) {
      angles_rad.push_back(sample.angle_rad);
    }
    return angles_rad;
  };
  const std::vector<double> whole = samples(1000);
  EXPECT_GT(whole.size(), 60U);
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 13U}) {
    EXPECT_EQ(samples(piece), whole) << piece;
  }
}

}  // namespace
}  // namespace odoless
