// `odoless emulate servo` from outside: what it refuses, and a session over a real terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "rt/clock.hpp"
#include "tests/support/command_process.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/servo_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using ::testing::HasSubstr;

TEST(EmulateServo, RefusesWhatMakesNoSense) {
  const test::Outcome nothing = test::run({"emulate", "servo"});
  EXPECT_EQ(nothing.status, 64);
  EXPECT_THAT(nothing.err, HasSubstr("--cia402 --can INTERFACE"));
  EXPECT_EQ(test::run({"emulate", "servo", "--cia402", "--pty", "x"}).status, 64);
  EXPECT_EQ(test::run({"emulate", "servo", "--cia402", "--dynamixel", "--can", "x", "--pty", "y"}).status, 64);
  const test::Outcome fault = test::run({"emulate", "servo", "--dynamixel", "--pty", "x", "--fault", "garbage@1"});
  EXPECT_EQ(fault.status, 64);
  EXPECT_THAT(fault.err, HasSubstr("not of a servo"));
  EXPECT_EQ(test::run({"emulate", "servo", "--dynamixel", "--pty", "x", "--fault", "error@1"}).status, 64);
  const test::Outcome interface = test::run({"emulate", "servo", "--cia402", "--can", "nocan9"});
  EXPECT_EQ(interface.status, 66);
  EXPECT_THAT(interface.err, HasSubstr("--can nocan9"));
}

/// What the owner of a session does, until it is level or the time is over.
void serve(const TiltParams& params, TiltSession& session, test::HeardTilt& heard, std::int64_t at_most_ns) {
  const MonotonicClock clock;
  const std::int64_t end_ns = clock.now_ns() + at_most_ns;
  Result<FileDescriptor> opened = Errc::kDeviceMissing;
  while (!(opened = open_tilt_line(params)).ok() && clock.now_ns() < end_ns) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(opened.ok()) << describe(opened.error());
  const FileDescriptor line = opened.take();
  std::array<std::byte, 256> buffer;
  session.reset(clock.now_ns());
  while (session.state() != TiltState::kLevel && clock.now_ns() < end_ns) {
    for (auto frame = session.transmit(); !frame.empty(); frame = session.transmit()) {
      ASSERT_EQ(write_tilt_line(params.driver, line.get(), frame), Errc::kOk);
    }
    pollfd ready{.fd = line.get(), .events = POLLIN, .revents = 0};
    ::poll(&ready, 1, 5);
    const Result<TiltRead> read = read_tilt_line(params.driver, line.get(), buffer, clock);
    if (read.ok()) {
      session.receive(read.value().bytes, read.value().arrival_ns, heard);
    }
    session.tick(clock.now_ns(), heard);
  }
}

TEST(EmulateServo, ADynamixelIsServedOverARealTerminal) {
  const test::TemporaryFolder folder;
  TiltParams params = test::servo_params(TiltDriver::kDynamixel);
  params.device = (folder.path() / "servo").string();
  params.baud = 0;
  params.reply_timeout_ns = 500 * kServoMs;
  params.stall_timeout_ns = 2 * kServoSecond;
  params.heartbeat_period_ns = 800 * kServoMs;
  const auto session = make_tilt_session(params);
  test::HeardTilt heard;
  test::CommandProcess emulator({"emulate", "servo", "--dynamixel", "--pty", params.device, "--echoes"});
  serve(params, *session, heard, 60 * kServoSecond);
  EXPECT_EQ(emulator.stop(SIGTERM), 0);
  EXPECT_EQ(session->state(), TiltState::kLevel);
  EXPECT_GT(heard.samples.size(), 5U);
  EXPECT_GT(session->counters().echoes, 5U);
}

}  // namespace
}  // namespace odoless
