#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>
#include <tuple>

#include "rt/cpu_clock.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::kMs;
using ::testing::HasSubstr;

constexpr const char* kWorld = "room 0 0  8 4\nspeed 1\ngo 1 2  1.5 2\n";

/// `odoless emulate lrf` in a process of its own.
class Emulator {
 public:
  explicit Emulator(const std::vector<std::string>& options) {
    process_ = ::fork();
    if (process_ == 0) {
      std::vector<const char*> argv{"odoless", "emulate", "lrf"};
      for (const std::string& option : options) {
        argv.push_back(option.c_str());
      }
      ::_exit(run_command_line(static_cast<int>(argv.size()), argv.data()));
    }
  }
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;
  ~Emulator() { static_cast<void>(stop(SIGKILL)); }

  /// Its exit status, or -1.
  int stop(int signal) {
    if (process_ <= 0) {
      return -1;
    }
    ::kill(process_, signal);
    int status = 0;
    ::waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_ = -1;
};

FileDescriptor open_when_there(const std::string& path) {
  for (int i = 0; i < 500; ++i) {
    if (Result<FileDescriptor> port = open_serial({.path = path}); port.ok()) {
      return port.take();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {};
}

/// What the owner of a session does, until that many scans were heard or ten seconds have passed.
void listen(const FileDescriptor& port, LrfSession& session, test::Heard& heard, std::size_t scans) {
  const std::int64_t end_ns = monotonic_ns() + 10 * test::kSecond;
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
  Emulator emulator({"--from", folder.file("a.world", kWorld), "--pty", pty, "--truth", truth});
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
  const double heard_s = static_cast<double>(second.scans.back().stamp_ns + offset_ns) * 1e-9;
  double nearest_s = 1e9;
  for (const double stamp_s : stamps_s) {
    nearest_s = std::min(nearest_s, std::abs(stamp_s - heard_s));
  }
  EXPECT_LT(nearest_s, 0.01);
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
  for (const auto& [model, params, ahead] : std::vector<std::tuple<std::string, LrfParams, std::size_t>>{
           {"lms291", sick, 180}, {"lms200", slow_sick, 180}, {"rplidar-a1", rplidar, 0}, {"rplidar-a2", express, 0}}) {
    SCOPED_TRACE(model);
    const test::TemporaryFolder folder;
    const std::string pty = folder.path() / "laser";
    const std::string world = folder.file("a.world", "room 0 0  8 4\nspeed 0.01\ngo 1 2  1.01 2\n");
    const Emulator emulator({"--from", world, "--pty", pty, "--model", model, "--noise-sd-m", "0"});
    const auto session = make_lrf_session(params, 2048);
    test::Heard heard;
    const FileDescriptor port = open_when_there(pty);
    ASSERT_TRUE(port.valid());
    listen(port, *session, heard, 8);
    ASSERT_GE(heard.scans.size(), 8U);
    EXPECT_EQ(session->line_baud(), serial_baud(port.get()));
    EXPECT_EQ(session->counters().rejected, 0U);
    EXPECT_NEAR(heard.scans.back().ranges_m[ahead], 7.0, 0.02);
    const std::int64_t since_ns = heard.scans.back().stamp_ns - heard.scans[heard.scans.size() - 2].stamp_ns;
    const auto period_ns = static_cast<double>(session->geometry().period_ns);
    EXPECT_NEAR(static_cast<double>(since_ns), period_ns, 0.2 * period_ns);
  }
}

TEST(Probe, FindsOutWhichProtocolALaserSpeaks) {
  for (const auto& [model, driver] :
       {std::pair("urg-04lx", "scip"), std::pair("lms200", "sick"), std::pair("rplidar-a1", "rplidar")}) {
    SCOPED_TRACE(model);
    const test::TemporaryFolder folder;
    const std::string pty = folder.path() / "laser";
    const std::string world = folder.file("a.world", kWorld);
    const Emulator emulator({"--from", world, "--pty", pty, "--model", model});
    ASSERT_TRUE(open_when_there(pty).valid());
    const test::Outcome outcome = test::run({"probe", pty, "--patience-s", "4"});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(fmt::format("driver = \"{}\"\ndevice = \"{}\"\n", driver, pty)));
  }
}

TEST(EmulateLrf, ServesALogAtItsRecordedPace) {
  const test::TemporaryFolder folder;
  std::string log;
  for (int i = 0; i < 12; ++i) {
    log += "FLASER 181";
    for (int beam = 0; beam < 181; ++beam) {
      log += fmt::format(" {}", 1.0 + 0.1 * i + 0.01 * beam);
    }
    log += fmt::format(" 0 0 0 0 0 0 {} host {}\n", 100 + 0.1 * i, 0.1 * i);
  }
  const std::string pty = folder.path() / "laser";
  Emulator emulator({"--from", folder.file("a.log", log), "--pty", pty, "--rate", "2"});
  const auto session = make_lrf_session({}, 2048);
  test::Heard heard;
  const FileDescriptor port = open_when_there(pty);
  ASSERT_TRUE(port.valid());
  listen(port, *session, heard, 10);
  ASSERT_GE(heard.scans.size(), 10U);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_NEAR(static_cast<double>(heard.scans[i].stamp_ns - heard.scans[i - 1].stamp_ns), 50.0 * kMs, 3.0 * kMs);
    EXPECT_NEAR(heard.scans[i].ranges_m[540], 1.9 + 0.1 * static_cast<double>(i), 0.001) << "straight ahead";
    EXPECT_TRUE(std::isinf(heard.scans[i].ranges_m[0])) << "beyond what was recorded";
  }
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
