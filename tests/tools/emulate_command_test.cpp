#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <thread>
#include <tuple>

#include "rt/cpu_clock.hpp"
#include "tests/support/command_process.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::kMs;
using ::testing::HasSubstr;

constexpr const char* kWorld = "room 0 0  8 4\nspeed 1\ngo 1 2  1.5 2\n";

FileDescriptor open_when_there(const std::string& path) {
  for (int i = 0; i < 3000; ++i) {
    if (Result<FileDescriptor> port = open_serial({.path = path}); port.ok()) {
      return port.take();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {};
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.at(values.size() / 2);
}

/// What the owner of a session does, until that many scans were heard or a minute has passed.
void listen(const FileDescriptor& port, LrfSession& session, test::Heard& heard, std::size_t scans) {
  const std::int64_t end_ns = monotonic_ns() + 60 * test::kSecond;
  session.reset(monotonic_ns());
  while (heard.scans.size() < scans && monotonic_ns() < end_ns) {
    if (session.line_baud() != 0 && session.line_baud() != serial_baud(port.get())) {
      ASSERT_EQ(set_serial_baud(port.get(), session.line_baud()), Errc::kOk);
    }
    const auto request = session.transmit();
    ASSERT_EQ(::write(port.get(), request.data(), request.size()), static_cast<ssize_t>(request.size()));
    pollfd line{.fd = port.get(), .events = POLLIN, .revents = 0};
    ::poll(&line, 1, 10);
    std::array<std::byte, 4096> bytes;
    const ssize_t count = ::read(port.get(), bytes.data(), bytes.size());
    const std::int64_t now_ns = monotonic_ns();
    session.receive({bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0U}, now_ns, heard);
    session.tick(now_ns, heard);
  }
}

TEST(EmulateLrf, ServesARealTerminalAndTellsTheTruth) {
  const test::TemporaryFolder folder;
  const std::string pty = folder.path() / "laser";
  const std::string truth = folder.path() / "truth.tum";
  test::CommandProcess emulator(
      {"emulate", "lrf", "--from", folder.file("a.world", kWorld), "--pty", pty, "--truth", truth});
  const auto session = make_lrf_session({}, 2048);
  test::Heard first;
  {
    const FileDescriptor port = open_when_there(pty);
    ASSERT_TRUE(port.valid());
    EXPECT_EQ(open_serial({.path = pty}).error(), Errc::kDeviceBusy);
    listen(port, *session, first, 50);
  }
  ASSERT_GE(first.scans.size(), 50U);
  test::Heard second;
  const FileDescriptor port = open_when_there(pty);
  listen(port, *session, second, 50);
  EXPECT_GE(second.scans.size(), 50U) << "after the client closed and opened it again";
  EXPECT_EQ(emulator.stop(SIGTERM), 0);
  EXPECT_FALSE(std::filesystem::is_symlink(pty));
  EXPECT_EQ(open_serial({.path = pty}).error(), Errc::kDeviceMissing);

  // The truth holds every scan that was heard; its clock is the monotonic one, moved to the Unix epoch.
  const auto offset_ns = std::chrono::system_clock::now().time_since_epoch().count() - monotonic_ns();
  std::ifstream lines(truth);
  std::vector<double> stamps_s;
  for (std::string line; std::getline(lines, line);) {
    stamps_s.push_back(std::stod(line));
  }
  EXPECT_GE(stamps_s.size(), first.scans.size() + second.scans.size());
  std::vector<double> errors_s;
  for (const test::HeardScan& scan : second.scans) {
    const double heard_s = static_cast<double>(scan.stamp_ns + offset_ns) * 1e-9;
    const auto after = std::lower_bound(stamps_s.begin(), stamps_s.end(), heard_s);
    const double after_s = after == stamps_s.end() ? 1e9 : *after - heard_s;
    errors_s.push_back(after == stamps_s.begin() ? after_s : std::min(after_s, heard_s - *(after - 1)));
  }
  EXPECT_LT(median(errors_s), 0.005) << "a busy machine makes some late";
  EXPECT_EQ(session->counters().rejected, 0U);
}

TEST(EmulateLrf, IsEveryLaserOnARealTerminal) {
  LrfParams sick;
  sick.driver = LrfDriver::kSick;
  sick.baud = 500000;
  LrfParams slow_sick = sick;
  slow_sick.baud = 38400;
  LrfParams rplidar;
  rplidar.driver = LrfDriver::kRplidar;
  LrfParams express = rplidar;
  express.rplidar_scan = RplidarScan::kExpress;
  LrfParams ldrobot;
  ldrobot.driver = LrfDriver::kLdrobot;
  LrfParams ydlidar;
  ydlidar.driver = LrfDriver::kYdlidar;
  for (const auto& [model, params, ahead] :
       std::vector<std::tuple<std::string, LrfParams, std::size_t>>{{"lms291", sick, 180},
                                                                    {"lms200", slow_sick, 180},
                                                                    {"rplidar-a1", rplidar, 0},
                                                                    {"rplidar-a2", express, 0},
                                                                    {"ld06", ldrobot, 0},
                                                                    {"ydlidar-x4", ydlidar, 0}}) {
    SCOPED_TRACE(model);
    const test::TemporaryFolder folder;
    const std::string pty = folder.path() / "laser";
    const std::string world = folder.file("a.world", "room 0 0  8 4\nspeed 0.01\ngo 1 2  1.01 2\n");
    const test::CommandProcess emulator(
        {"emulate", "lrf", "--from", world, "--pty", pty, "--model", model, "--noise-sd-m", "0"});
    const auto session = make_lrf_session(params, 2048);
    test::Heard heard;
    const FileDescriptor port = open_when_there(pty);
    ASSERT_TRUE(port.valid());
    listen(port, *session, heard, 8);
    ASSERT_GE(heard.scans.size(), 8U);
    EXPECT_EQ(session->line_baud(), serial_baud(port.get()));
    EXPECT_EQ(session->counters().rejected, 0U);
    // Where a reader is too late, bytes of a laser that sends all the time are lost, as on a real line.
    std::size_t seen = 0;
    for (const test::HeardScan& scan : heard.scans) {
      if (scan.ranges_m[ahead] != 0.0F) {
        EXPECT_NEAR(scan.ranges_m[ahead], 7.0, 0.02);
        ++seen;
      }
    }
    EXPECT_GE(seen + 1, heard.scans.size());
    std::vector<double> since_ns;  // the scan before
    for (std::size_t i = 1; i < heard.scans.size(); ++i) {
      since_ns.push_back(static_cast<double>(heard.scans[i].stamp_ns - heard.scans[i - 1].stamp_ns));
    }
    const auto period_ns = static_cast<double>(session->geometry().period_ns);
    EXPECT_NEAR(median(since_ns), period_ns, 0.2 * period_ns) << "a busy machine makes some late";
  }
}

TEST(Probe, FindsOutWhichProtocolALaserSpeaks) {
  const std::map<std::string, std::string> driver_of{{"urg-04lx", "scip"},      {"lms200", "sick"},
                                                     {"rplidar-a1", "rplidar"}, {"ld19", "ldrobot"},
                                                     {"ydlidar-x2", "ydlidar"}, {"ydlidar-x4", "ydlidar"}};
  const test::TemporaryFolder folder;
  const std::string world = folder.file("a.world", kWorld);
  std::map<std::string, test::CommandProcess> emulators;
  std::map<std::string, test::CommandProcess> probes;  // at a time: they mostly wait
  for (const auto& [model, driver] : driver_of) {
    const std::string pty = folder.path() / model;
    emulators.try_emplace(model,
                          std::vector<std::string>{"emulate", "lrf", "--from", world, "--pty", pty, "--model", model});
    ASSERT_TRUE(open_when_there(pty).valid());
    probes.try_emplace(model, std::vector<std::string>{"probe", pty, "--patience-s", "4"}, pty + ".txt");
  }
  for (auto& [model, probe] : probes) {
    const std::string pty = folder.path() / model;
    EXPECT_EQ(probe.wait(), 0) << model;
    EXPECT_THAT(test::content_of(pty + ".txt"),
                HasSubstr(fmt::format("driver = \"{}\"\ndevice = \"{}\"\n", driver_of.at(model), pty)));
  }
}

// At which pace: emulate_session_test.cpp, in made-up time.
TEST(EmulateLrf, ServesALogInItsOrder) {
  constexpr int kScans = 12;
  const test::TemporaryFolder folder;
  std::string log;
  for (int i = 0; i < kScans; ++i) {
    log += "FLASER 181";
    for (int beam = 0; beam < 181; ++beam) {
      log += fmt::format(" {}", 1.0 + 0.1 * i + 0.01 * beam);
    }
    log += fmt::format(" 0 0 0 0 0 0 {} host {}\n", 100 + 0.1 * i, 0.1 * i);
  }
  const std::string pty = folder.path() / "laser";
  const test::CommandProcess emulator(
      {"emulate", "lrf", "--from", folder.file("a.log", log), "--pty", pty, "--rate", "2"});
  const auto session = make_lrf_session({}, 2048);
  test::Heard heard;
  const FileDescriptor port = open_when_there(pty);
  ASSERT_TRUE(port.valid());
  listen(port, *session, heard, kScans);
  ASSERT_GE(heard.scans.size(), static_cast<std::size_t>(kScans));
  int last = -1;
  for (const test::HeardScan& scan : heard.scans) {
    const double recorded = (scan.ranges_m[540] - 1.9) / 0.1;  // straight ahead
    const int index = static_cast<int>(std::lround(recorded));
    EXPECT_NEAR(recorded, index, 0.01);
    EXPECT_TRUE(index > last || (index == last && last == kScans - 1)) << index << " after " << last;
    EXPECT_TRUE(std::isinf(scan.ranges_m[0])) << "beyond what was recorded";
    last = index;
  }
  EXPECT_LT(last, kScans);
}

TEST(EmulateLrf, StopsAtTheEndOrAfterItsTime) {
  const test::TemporaryFolder folder;
  const std::string world = folder.file("a.world", kWorld);
  const std::string pty = folder.path() / "laser";
  const test::Outcome at_end =
      test::run({"emulate", "lrf", "--from", world, "--pty", pty, "--start-at-once", "--stop-at-end", "--rate", "5"});
  EXPECT_EQ(at_end.status, 0) << at_end.err;
  EXPECT_THAT(at_end.out, HasSubstr("path done\n0 scans sent, 0 dropped\n"));
  const test::Outcome in_time = test::run({"emulate", "lrf", "--from", world, "--pty", pty, "--duration-s", "0.05"});
  EXPECT_EQ(in_time.status, 0) << in_time.err;
  EXPECT_THAT(in_time.out, ::testing::Not(HasSubstr("path done")));
}

TEST(EmulateLrf, RefusesWrongUse) {
  const test::TemporaryFolder folder;
  const std::string world = folder.file("a.world", kWorld);
  const std::string pty = folder.path() / "laser";
  const auto status = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"emulate", "lrf", "--duration-s", "0.01"});
    return test::run(more).status;
  };
  EXPECT_EQ(status({"--from", world, "--pty", pty}), 0);
  EXPECT_EQ(status({"--from", "no/such.world", "--pty", pty}), 66);
  EXPECT_EQ(status({"--from", "no/such.log", "--pty", pty}), 66);
  EXPECT_EQ(status({"--from", world, "--pty", world}), 73) << "not even by a link is a file replaced";
  EXPECT_EQ(status({"--from", world, "--pty", pty, "--truth", "no/such/folder/truth"}), 73);
  EXPECT_EQ(status({"--from", world, "--pty", pty, "--model", "none"}), 64);
  for (const char* const fault : {"none@1", "silence", "silence@-1", "silence@x", "silence@1:0", "silence=3@1",
                                  "drift@1", "drift=x@1", "silence@1:x", "@", ""}) {
    EXPECT_EQ(status({"--from", world, "--pty", pty, "--fault", fault}), 64) << fault;
  }
  EXPECT_EQ(test::run({"emulate"}).status, 64);
  EXPECT_TRUE(std::filesystem::is_regular_file(world));
  EXPECT_FALSE(std::filesystem::exists(pty));
}

}  // namespace
}  // namespace odoless
