// What `odoless probe ADDRESS` finds out of a laser, on real lines.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <set>
#include <thread>

#include "rt/cpu_clock.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/lrf_emulator.hpp"
#include "tools/emulate/pseudo_terminal.hpp"
#include "tools/emulate/sick_device.hpp"
#include "tools/emulate/tcp_server_line.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

/// An emulated laser that is served on a thread as long as this lives.
class ServedLrf {
 public:
  ServedLrf(const std::string& model, EmulatedLine& line, EmulatedLrfOptions options = {})
      : source_(test::period_ns_of(model), test::small_drive()),
        device_(make_emulated_lrf(model, source_, std::move(options), monotonic_ns())),
        looped_(*device_, source_, line, "", [] {}),
        thread_([this] { serve(); }) {}
  ServedLrf(const ServedLrf&) = delete;
  ServedLrf& operator=(const ServedLrf&) = delete;
  ~ServedLrf() { stop(); }

  void stop() {
    is_over_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  [[nodiscard]] const EmulatedLrf& device() const { return *device_; }

 private:
  void serve() {
    while (!is_over_) {
      looped_.step(monotonic_ns());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  WorldSource source_;
  std::unique_ptr<EmulatedLrf> device_;
  LoopedLrf looped_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

/// A line on which a laser of RS-232 hears only what is said at its rate, until it is told another. It keeps in mind at
/// which rates somebody spoke.
class Rs232 final : public EmulatedLine {
 public:
  Rs232(std::filesystem::path link, int baud) : terminal_(std::move(link)), baud_(baud) {}

  [[nodiscard]] int descriptor() const override { return terminal_.descriptor(); }
  [[nodiscard]] std::string path() const override { return terminal_.path(); }
  [[nodiscard]] bool has_client() override { return terminal_.has_client(); }
  [[nodiscard]] std::string read() override {
    const int baud = terminal_.baud();
    std::string bytes = terminal_.read();
    if (bytes.find("QT\n") != std::string::npos) {
      asked_baud_.insert(baud);
    }
    if (baud != baud_) {
      return {};
    }
    baud_ = bytes.find("SS115200\n") != std::string::npos ? 115200 : baud_;
    return bytes;
  }
  [[nodiscard]] std::size_t write(std::string_view bytes) override { return terminal_.write(bytes); }

  [[nodiscard]] const std::set<int>& asked_baud() const { return asked_baud_; }

 private:
  PseudoTerminal terminal_;
  int baud_;
  std::set<int> asked_baud_;
};

TEST(ProbeSick, TellsWhatItIsSetToAndWritesNothing) {
  const test::TemporaryFolder folder;
  const std::string pty = folder.path() / "laser";
  PseudoTerminal line(pty);
  ServedLrf laser("lms291-quarter", line);  // in cm at first
  const test::Outcome outcome = test::run({"probe", pty});
  laser.stop();
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("a laser that speaks SICK's telegrams: 401 beams over 100.0 deg, 0.00 to 81.8 m"));
  EXPECT_THAT(outcome.out, HasSubstr("\nbaud = 9600\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nsick_variant = \"100/0.25\"\nsick_unit = \"cm\"\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("mode")));
  EXPECT_EQ(static_cast<const SickDevice&>(laser.device()).writes(), 0);
}

TEST(ProbeSick, IsFoundBehindADeviceServerTheRateOfWhichIsNotOurs) {
  TcpServerLine line(0);
  const ServedLrf laser("lms200", line);
  const test::Outcome outcome = test::run({"probe", line.path(), "--patience-s", "1.5"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("driver = \"sick\"\ndevice = \"" + line.path() + "\"\n# baud = "));
  EXPECT_THAT(outcome.out, HasSubstr("Hz or more")) << "nothing tells what the far end's line carries";
  EXPECT_THAT(outcome.out, Not(HasSubstr("RS-232"))) << "it is asked only where the rate is ours";
}

TEST(ProbeRplidar, TellsTheRateThatItsMotorTurnsAt) {
  for (const auto& [model, baud] : {std::pair("rplidar-a2", 115200), {"rplidar-s2", 1000000}}) {
    const test::TemporaryFolder folder;
    const std::string pty = folder.path() / "laser";
    PseudoTerminal line(pty);
    const ServedLrf laser(model, line);
    const test::Outcome outcome = test::run({"probe", pty, "--patience-s", "2"});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(fmt::format("360 beams over 359.0 deg, 0.15 to {}.0 m, 10.0 Hz\n",
                                                   baud == 115200 ? 12 : 30)));
    EXPECT_THAT(outcome.out, HasSubstr(fmt::format("\nbaud = {}\n", baud)));
  }
}

TEST(ProbeScip, FindsALaserOnRs232) {
  const test::TemporaryFolder folder;
  const std::string pty = folder.path() / "laser";
  Rs232 line(pty, 19200);
  const ServedLrf laser("urg-04lx", line);
  const test::Outcome outcome = test::run({"probe", pty});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("682 beams"));
  EXPECT_THAT(outcome.out, HasSubstr("driver = \"scip\"\ndevice = \"" + pty + "\"\nbaud = 115200\n"));
}

TEST(ProbeScip, AsksAtEveryRateInTheTimeThatItHas) {
  const test::TemporaryFolder folder;
  const std::string pty = folder.path() / "laser";
  Rs232 line(pty, 1);  // no rate of ours: nobody answers
  ServedLrf laser("urg-04lx", line);
  const std::int64_t start_ns = monotonic_ns();
  const test::Outcome outcome = test::run({"probe", pty, "--patience-s", "2"});
  EXPECT_LT(monotonic_ns() - start_ns, 12 * test::kSecond)
      << "2 s for each of five protocols and 1 s for LDROBOT's, and a second more";
  laser.stop();
  EXPECT_EQ(outcome.status, 69);
  EXPECT_THAT(line.asked_baud(), IsSupersetOf({19200, 57600, 115200, 250000, 500000, 750000}));
}

TEST(Probe, TellsOfALaserThatAnswersButDoesNotScan) {
  const test::TemporaryFolder folder;
  const std::string pty = folder.path() / "laser";
  PseudoTerminal line(pty);
  const ServedLrf laser("urg-04lx", line, {.faults = {parse_fault("garbage@0")}});
  const test::Outcome outcome = test::run({"probe", pty, "--patience-s", "1"});
  EXPECT_EQ(outcome.status, 0) << "it answers";
  EXPECT_THAT(outcome.out, HasSubstr("it answers, but no scan came within 1 s; does its motor turn?\n[lrf]\n"));
  std::string said = outcome.out;
  for (std::size_t at = said.find(pty); at != std::string::npos; at = said.find(pty)) {
    said.erase(at, pty.size());  // whose name is of any letters
  }
  EXPECT_THAT(said, Not(HasSubstr("Hz")));
}

}  // namespace
}  // namespace odoless
