#include "firmware/daemon/control_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

using Kind = ControlCommand::Kind;
using ::testing::HasSubstr;

std::string refusal_of(std::string_view line) {
  const auto parsed = parse_control_command(line);
  const auto* const refusal = std::get_if<std::string>(&parsed);
  return refusal != nullptr ? *refusal : "";
}

TEST(ControlCommand, ReadsEachCommand) {
  for (const auto& [line, kind] : {std::pair{"status", Kind::kStatus},
                                   {"status json", Kind::kStatusJson},
                                   {"world", Kind::kWorld},
                                   {"world json", Kind::kWorldJson},
                                   {"localise", Kind::kLocalise},
                                   {"map", Kind::kMap},
                                   {"save", Kind::kSave},
                                   {"reset", Kind::kReset},
                                   {"pause", Kind::kPause},
                                   {"resume", Kind::kResume},
                                   {"stop", Kind::kStop},
                                   {"pose 1 2 90", Kind::kPose},
                                   {"  tilt  sweep ", Kind::kTilt}}) {
    SCOPED_TRACE(line);
    const auto parsed = parse_control_command(line);
    ASSERT_TRUE(std::holds_alternative<ControlCommand>(parsed)) << refusal_of(line);
    EXPECT_EQ(std::get<ControlCommand>(parsed).kind, kind);
  }
  const auto pose = std::get<ControlCommand>(parse_control_command("pose -1.5 2e0 -270")).map_T_robot;
  EXPECT_EQ(pose.x_m, -1.5);
  EXPECT_EQ(pose.y_m, 2.0);
  EXPECT_NEAR(pose.yaw_rad, std::numbers::pi / 2.0, 1e-12);
  EXPECT_EQ(std::get<ControlCommand>(parse_control_command("tilt sweep")).tilt, TiltCommand::kSweep);
}

TEST(ControlCommand, SavesWhereItIsTold) {
  const auto plain = std::get<ControlCommand>(parse_control_command("save"));
  EXPECT_EQ(plain.folder, "");
  const auto named = std::get<ControlCommand>(parse_control_command("save /a folder/b"));
  EXPECT_EQ(named.folder, "/a folder/b");
  EXPECT_FALSE(named.is_forced);
  const auto forced = std::get<ControlCommand>(parse_control_command("save --force  /a"));
  EXPECT_EQ(forced.folder, "/a");
  EXPECT_TRUE(forced.is_forced);
  for (const char* const line : {"save a/b", "save --force", "save --force b", "save /a\tb", "save -f /a"}) {
    EXPECT_THAT(refusal_of(line), HasSubstr("save [--force] /PATH")) << line;
  }
}

TEST(ControlCommand, RefusesAPoseThatCannotBe) {
  for (const char* const line : {"pose 1e308 0 0", "pose 0 -1e308 0", "pose 10000.1 0 0", "pose 0 -10000.1 0"}) {
    EXPECT_THAT(refusal_of(line), HasSubstr("from -10000 to 10000 m")) << line;
  }
  for (const char* const line : {"pose 0 0 1e308", "pose 0 0 -360.1"}) {
    EXPECT_THAT(refusal_of(line), HasSubstr("from -360 to 360 deg")) << line;
  }
  for (const char* const line : {"pose", "pose 1 2", "pose nan 0 0", "pose 0 inf 0", "pose 0 0 1e999", "pose 1 2 3 4",
                                 "pose 1 2 3x", "pose 1,2,3", "pose 0x1 0 0"}) {
    EXPECT_THAT(refusal_of(line), HasSubstr("three numbers: X_M Y_M YAW_DEG")) << line;
  }
}

TEST(ControlCommand, RefusesWhatIsNoneAndSaysWhatThereIs) {
  for (const char* const line : {"", "dance", "statusx", "STATUS", "pose1 2 3"}) {
    EXPECT_THAT(refusal_of(line),
                HasSubstr("is no command; there are status [json], world [json], save [[--force] /PATH], reset, pose"))
        << line;
  }
  EXPECT_THAT(refusal_of("tilt up"), HasSubstr("level, sweep, stop"));
  EXPECT_THAT(refusal_of("reset now"), HasSubstr("no argument"));
  EXPECT_EQ(refusal_of(std::string(1000, 'x')).size() < 250, true) << "what was sent is not thrown back whole";
  EXPECT_EQ(refusal_of("a\x1b[2Jb").find('\x1b'), std::string::npos) << "nor what a terminal would obey";
}

TEST(ControlCommand, WhateverComesIsRefusedOrWithinItsLimits) {
  const std::string letters = "poseautilt 0123456789.-+enfi\n\xff";
  Rng rng(7);
  for (int i = 0; i < 100'000; ++i) {
    std::string line = rng.below(2) == 0 ? "pose " : "";
    for (std::uint32_t left = rng.below(30); left > 0; --left) {
      line += letters[rng.below(static_cast<std::uint32_t>(letters.size()))];
    }
    const auto parsed = parse_control_command(line);
    if (const auto* const command = std::get_if<ControlCommand>(&parsed)) {
      ASSERT_LE(std::abs(command->map_T_robot.x_m), kPoseMax_m) << line;
      ASSERT_LE(std::abs(command->map_T_robot.y_m), kPoseMax_m) << line;
      ASSERT_LE(std::abs(command->map_T_robot.yaw_rad), std::numbers::pi) << line;
    } else {
      ASSERT_FALSE(refusal_of(line).empty());
    }
  }
}

}  // namespace
}  // namespace odoless
