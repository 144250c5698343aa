#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "drivers/io/device_line.hpp"
#include "firmware/sources/lrf_source.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/keys/transcript.hpp"
#include "tests/support/times.hpp"
#include "tools/emulate/lrf_models.hpp"
#include "tools/emulate/pseudo_terminal.hpp"
#include "tools/emulate/world_source.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::test {
namespace {

using test::kMs;
using test::kSecond;

std::int64_t period_ns_of(const std::string& model) {
  const std::vector<EmulatedLrfModel> models = emulated_lrf_models();
  return std::find_if(models.begin(), models.end(), [&](const EmulatedLrfModel& known) { return known.name == model; })
      ->period_ns;
}

WorldDrive drive() {
  WorldDrive drive;
  drive.world = parse_world("room 0 0  8 4\nbox 6 3  1 0.6\nspeed 1\ngo 1 2  6 2\n", "keys");
  return drive;
}

/// An emulated laser on its line to the daemon's source of scans, in made-up time.
class LaserBench {
 public:
  LaserBench(const std::string& model, const EmulatedLrfOptions& options, const DaemonParams& params)
      : scans_(period_ns_of(model), drive()),
        laser_(make_emulated_lrf(model, scans_, options, now_ns_)),
        source_(params.lrf, params.robot.scan.beams_max, line_) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    near_ = FileDescriptor(ends[0]);
    far_ = FileDescriptor(ends[1]);
    line_.offer(near_.get());
    source_.attach(gpio_, params.gpio.sync_line.empty() ? std::nullopt : std::optional(params.gpio.sync_delay_ns));
  }

  [[nodiscard]] std::string run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kMs) {
      source_.work(ManualClock(now_ns_), heard_);
      std::array<char, 4096> bytes{};
      const ssize_t size = ::read(far_.get(), bytes.data(), bytes.size());
      laser_->receive({bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))}, now_ns_);
      laser_->tick(now_ns_);
      for (const SentBytes& sent : laser_->take_output()) {
        EXPECT_EQ(::write(far_.get(), sent.bytes.data(), sent.bytes.size()), static_cast<ssize_t>(sent.bytes.size()));
        if (sent.scan) {
          static_cast<void>(gpio_.sync_pulses_ns.try_push(sent.scan->first_beam_ns - 3 * kMs));
        }
      }
    }
    return heard_.text();
  }

 private:
  std::int64_t now_ns_ = 1000 * kSecond;
  WorldSource scans_;
  std::unique_ptr<EmulatedLrf> laser_;
  GpioSignals gpio_;
  LineHandover line_;
  LrfSource source_;
  FileDescriptor near_;
  FileDescriptor far_;
  Transcript heard_;
};

Scene session_with(const std::string& model, const std::string& toml, const std::string& fault = "",
                   std::int64_t duration_ns = 3 * kSecond) {
  EmulatedLrfOptions options;
  if (!fault.empty()) {
    options.faults = {parse_fault(fault)};
  }
  return {model + " " + fault, {"[lrf]\n" + toml}, [model, options, duration_ns](const DaemonParams& params) {
            return params.lrf.driver == LrfDriver::kLcm ? "no laser"
                                                        : LaserBench(model, options, params).run(duration_ns);
          }};
}

/// What opening the line comes to.
Scene opening() {
  const auto terminal = std::make_shared<PseudoTerminal>(std::filesystem::temp_directory_path() /
                                                         fmt::format("odoless-keys-{}", ::getpid()));
  return {"opening", {"[lrf]\ndevice = \"" + terminal->path() + "\"\n"}, [terminal](const DaemonParams& params) {
            DeviceLine line(params.lrf.device, params.lrf.baud);
            const Result<FileDescriptor> opened = line.open(0);
            return opened.ok() ? "open" : fmt::format("{}: {}", params.lrf.device, describe(opened.error()));
          }};
}

std::vector<Scene> all_laser_scenes() {
  const std::string synchronised = "[gpio]\nsync_line = \"pulse\"\n";
  return {session_with("utm-30lx", "driver = \"scip\"\n" + synchronised),
          session_with("lms200", "driver = \"sick\"\nsick_variant = \"180/1\"\n", "", 20 * kSecond),
          session_with("rplidar-a2", "driver = \"rplidar\"\n"),
          session_with("ld19", "driver = \"ldrobot\"\nbaud = 230400\n"),
          session_with("ydlidar-x4", "driver = \"ydlidar\"\nbaud = 128000\n"),
          session_with("lms111", "driver = \"sopas\"\n"),
          session_with("utm-30lx", "driver = \"scip\"\n", "silence@1:0.7"),
          opening()};
}

}  // namespace

KeyClass laser_class() { return {"laser", {"lrf.", "gpio.sync_delay"}, all_laser_scenes}; }

}  // namespace odoless::test
