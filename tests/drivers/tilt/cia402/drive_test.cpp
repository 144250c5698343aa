#include "drivers/tilt/cia402/drive.hpp"

#include <gtest/gtest.h>

#include "drivers/tilt/cia402/set_up.hpp"

namespace odoless::cia402 {
namespace {

// CiA 402-2, table of the status word: bits that the mask leaves out may be anything.
TEST(PowerState, EveryStatusWordHasItsState) {
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto state = power_state(static_cast<std::uint16_t>(word));
    const unsigned four = word & 0x0FU;
    const bool bit5 = (word & 0x20U) != 0;
    const bool bit6 = (word & 0x40U) != 0;
    std::optional<PowerState> wanted;
    if (four == 0x00) {
      wanted = bit6 ? PowerState::kSwitchOnDisabled : PowerState::kNotReady;
    } else if (four == 0x0F && !bit6) {
      wanted = PowerState::kFaultReaction;
    } else if (four == 0x08 && !bit6) {
      wanted = PowerState::kFault;
    } else if (four == 0x07 && !bit6) {
      wanted = bit5 ? PowerState::kEnabled : PowerState::kQuickStop;
    } else if (four == 0x01 && !bit6 && bit5) {
      wanted = PowerState::kReady;
    } else if (four == 0x03 && !bit6 && bit5) {
      wanted = PowerState::kSwitchedOn;
    }
    ASSERT_EQ(state, wanted) << std::hex << word;
  }
}

TEST(PowerState, AFaultIsResetByARisingEdge) {
  EXPECT_EQ(towards_enabled(PowerState::kFault, 0), kFaultReset);
  EXPECT_EQ(towards_enabled(PowerState::kFault, kFaultReset), kDisableVoltage);
  EXPECT_EQ(towards_enabled(PowerState::kFault, kEnableOperation), kFaultReset);
}

std::uint16_t status_word(PowerState state) {
  constexpr std::uint16_t kWords[] = {0x0200, 0x0250, 0x0231, 0x0233, 0x0237, 0x0217, 0x020F, 0x0208};
  return kWords[static_cast<std::size_t>(state)];
}

/// The state that a control word leads to (CiA 402-2, state transitions), a step at a time.
PowerState follow(PowerState state, std::uint16_t before, std::uint16_t control) {
  const bool enables = (control & 0x0FU) == 0x0F;
  switch (state) {
    case PowerState::kNotReady:
      return PowerState::kSwitchOnDisabled;
    case PowerState::kFaultReaction:
      return PowerState::kFault;
    case PowerState::kFault:
      return (control & ~before & kFaultReset) != 0 ? PowerState::kSwitchOnDisabled : state;
    case PowerState::kSwitchOnDisabled:
      return (control & 0x07U) == 0x06 ? PowerState::kReady : state;
    case PowerState::kReady:
      return (control & 0x02U) == 0      ? PowerState::kSwitchOnDisabled
             : (control & 0x0FU) == 0x07 ? PowerState::kSwitchedOn
                                         : state;
    case PowerState::kSwitchedOn:
      return (control & 0x02U) == 0 ? PowerState::kSwitchOnDisabled : enables ? PowerState::kEnabled : state;
    case PowerState::kEnabled:
      return (control & 0x02U) == 0   ? PowerState::kSwitchOnDisabled
             : (control & 0x04U) == 0 ? PowerState::kQuickStop
                                      : state;
    case PowerState::kQuickStop:
      return (control & 0x02U) == 0 ? PowerState::kSwitchOnDisabled : state;  // it lacks transition 16
  }
  return state;
}

TEST(Drive, EnablesADriveFromEveryState) {
  for (int first = 0; first <= static_cast<int>(PowerState::kFault); ++first) {
    for (const std::uint16_t before : {std::uint16_t{0}, std::uint16_t{0x0F}, std::uint16_t{0x80}}) {
      Drive drive;
      auto state = static_cast<PowerState>(first);
      std::uint16_t last = before;
      int cycles = 0;
      for (; cycles < 60 && state != PowerState::kEnabled; ++cycles) {
        drive.on_status({.status_word = status_word(state), .mode = 1});
        const std::uint16_t control = drive.next(Drive::Goal::kMove, 0).control_word;
        state = follow(state, last, control);
        last = control;
      }
      EXPECT_EQ(state, PowerState::kEnabled) << "from " << first;
      EXPECT_TRUE(first == static_cast<int>(PowerState::kQuickStop) || cycles <= 6) << "from " << first;
    }
  }
}

TEST(Drive, StopsADriveFromEveryStateAndEnablesNone) {
  for (int first = 0; first <= static_cast<int>(PowerState::kFault); ++first) {
    Drive drive;
    auto state = static_cast<PowerState>(first);
    std::uint16_t last = 0;
    for (int i = 0; i < 60; ++i) {
      drive.on_status({.status_word = status_word(state), .mode = 1});
      const std::uint16_t control = drive.next(Drive::Goal::kStop, 77).control_word;
      state = follow(state, last, control);
      last = control;
      ASSERT_NE(state, PowerState::kEnabled);
      ASSERT_EQ(control & (kNewSetPoint | kFaultReset), 0);
    }
  }
}

// It may hold the axis up, enabled and in a quick stop.
TEST(Drive, TakesNoTorqueFromADriveThatHasNotToldItsState) {
  Drive drive;
  for (const Drive::Goal goal : {Drive::Goal::kStop, Drive::Goal::kWait, Drive::Goal::kMove, Drive::Goal::kHome}) {
    EXPECT_EQ(drive.next(goal, 0).control_word, kQuickStopControl);
  }
}

TEST(Drive, ShowsANewTargetUntilItIsTaken) {
  Drive drive;
  const std::uint16_t enabled = status_word(PowerState::kEnabled);
  drive.on_status({.status_word = enabled, .mode = 1});
  const Drive::Output shown = drive.next(Drive::Goal::kMove, 500);
  EXPECT_EQ(shown.control_word, 0x3F);
  EXPECT_EQ(shown.target_counts, 500);
  drive.on_status({.status_word = enabled, .mode = 1});
  const Drive::Output still = drive.next(Drive::Goal::kMove, 900);
  EXPECT_EQ(still.control_word, 0x3F);
  EXPECT_EQ(still.target_counts, 500) << "it must not change under way";
  drive.on_status({.status_word = static_cast<std::uint16_t>(enabled | kSetPointAcknowledged), .mode = 1});
  EXPECT_EQ(drive.next(Drive::Goal::kMove, 900).control_word, 0x0F);
  drive.on_status({.status_word = static_cast<std::uint16_t>(enabled | kSetPointAcknowledged), .mode = 1});
  EXPECT_EQ(drive.next(Drive::Goal::kMove, 900).control_word, 0x0F) << "the acknowledge is still there";
  drive.on_status({.status_word = enabled, .mode = 1});
  const Drive::Output next = drive.next(Drive::Goal::kMove, 900);
  EXPECT_EQ(next.control_word, 0x3F);
  EXPECT_EQ(next.target_counts, 900);
  drive.on_status({.status_word = static_cast<std::uint16_t>(enabled | kSetPointAcknowledged), .mode = 1});
  static_cast<void>(drive.next(Drive::Goal::kMove, 900));
  for (int i = 0; i < 5; ++i) {
    drive.on_status({.status_word = enabled, .mode = 1});
    EXPECT_EQ(drive.next(Drive::Goal::kMove, 900).control_word, 0x0F) << "it goes there already";
  }
}

TEST(Drive, ShowsTheTargetAnewAfterItWasSwitchedOff) {
  Drive drive;
  const std::uint16_t enabled = status_word(PowerState::kEnabled);
  drive.on_status({.status_word = enabled, .mode = 1});
  static_cast<void>(drive.next(Drive::Goal::kMove, 500));
  drive.on_status({.status_word = static_cast<std::uint16_t>(enabled | kSetPointAcknowledged), .mode = 1});
  static_cast<void>(drive.next(Drive::Goal::kMove, 500));
  drive.on_status({.status_word = status_word(PowerState::kSwitchOnDisabled), .mode = 1});
  EXPECT_EQ(drive.next(Drive::Goal::kMove, 500).control_word, kShutdown);
  drive.on_status({.status_word = enabled, .mode = 1});
  EXPECT_EQ(drive.next(Drive::Goal::kMove, 500).control_word, 0x3F);
}

TEST(Drive, TellsHomingByItsBits) {
  Drive drive;
  const std::uint16_t enabled = status_word(PowerState::kEnabled);
  const auto cycle = [&](int extra) {
    drive.on_status({.status_word = static_cast<std::uint16_t>(enabled | extra), .mode = 6});
    EXPECT_EQ(drive.next(Drive::Goal::kHome, 0).control_word, 0x1F);
  };
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(drive.homing(), HomingState::kUnderWay) << "bits of before don't count";
    cycle(kSetPointAcknowledged | kTargetReached);
  }
  cycle(0);
  EXPECT_EQ(drive.homing(), HomingState::kUnderWay);
  cycle(kTargetReached);
  EXPECT_EQ(drive.homing(), HomingState::kUnderWay);
  cycle(kSetPointAcknowledged | kTargetReached);
  EXPECT_EQ(drive.homing(), HomingState::kAttained);
  cycle(kFollowingError);
  EXPECT_EQ(drive.homing(), HomingState::kFailed);
}

TEST(DriveSetUp, PdosAreInvalidWhileTheirMappingChanges) {
  TiltParams params;
  params.homing_method = 17;
  const cia402::SetUp set_up(params, TiltScale(params, params.counts_per_turn, 0.0));
  std::uint32_t cob = 0;
  std::uint32_t mapped = 1;
  for (const Setting& setting : set_up.settings()) {
    const bool is_communication = setting.object.index == 0x1400 || (setting.object.index & 0xFF00U) == 0x1800;
    const bool is_mapping = setting.object.index == 0x1600 || (setting.object.index & 0xFF00U) == 0x1A00;
    if (is_communication && setting.object.sub == 1) {
      EXPECT_NE(cob >> 31U, setting.value >> 31U) << "off, then on";
      cob = setting.value;
    } else if (is_mapping) {
      EXPECT_EQ(cob >> 31U, 1U);
      EXPECT_TRUE(setting.object.sub == 0 || mapped == 0);
      mapped = setting.object.sub == 0 ? setting.value : mapped;
    }
  }
  EXPECT_EQ(cob >> 31U, 0U);
}

TEST(DriveSetUp, ADriveMayLackWhatItCanDoWithout) {
  const Setting optional{{0x605A, 0}, 6, 2, true};
  const Setting needed{{0x6081, 0}, 100, 4, false};
  EXPECT_TRUE(cia402::SetUp::tolerates(optional, 0x06020000));
  EXPECT_TRUE(cia402::SetUp::tolerates(optional, 0x06010002));
  EXPECT_TRUE(cia402::SetUp::tolerates(optional, 0x06090030)) << "drives refuse a value that they do not know, too";
  EXPECT_FALSE(cia402::SetUp::tolerates(needed, 0x06020000));
  EXPECT_FALSE(cia402::SetUp::tolerates(needed, 0x06090030)) << "a value out of range is a mistake of somebody";
}

}  // namespace
}  // namespace odoless::cia402
