#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>

#include "drivers/tilt/tilt_line.hpp"
#include "firmware/sources/tilt_source.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/keys/transcript.hpp"
#include "tests/support/times.hpp"
#include "tools/emulate/cia402_device.hpp"
#include "tools/emulate/dynamixel_device.hpp"
#include "tools/emulate/maestro_device.hpp"

namespace odoless::test {
namespace {

using test::kMs;
using test::kSecond;
constexpr std::int64_t kStart_ns = 1000 * kSecond;

/// Of the protocol that is spoken; all else is the servo's own affair.
std::unique_ptr<EmulatedServo> servo_of(TiltDriver driver, const std::vector<Fault>& faults) {
  if (driver == TiltDriver::kCia402) {
    Cia402DeviceOptions options;
    options.faults = faults;
    options.home_rad = -0.4;
    return std::make_unique<Cia402Device>(options, kStart_ns);
  }
  if (driver == TiltDriver::kMaestro) {
    MaestroDeviceOptions options;
    options.is_on = true;
    options.faults = faults;
    return std::make_unique<MaestroDevice>(options, kStart_ns);
  }
  DynamixelDeviceOptions options;
  options.start_rad = 0.2;
  options.faults = faults;
  return std::make_unique<DynamixelDevice>(options, kStart_ns);
}

/// An emulated servo on its line to the daemon's part for it, in made-up time.
std::string served(const TiltParams& params, const std::vector<Fault>& faults, std::int64_t duration_ns) {
  if (params.driver == TiltDriver::kNone) {
    return "no servo";
  }
  std::array<int, 2> ends{};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
  const FileDescriptor near(ends[0]);
  const FileDescriptor far(ends[1]);
  LineHandover line;
  line.offer(near.get());
  TiltSource source(params, line);
  const std::unique_ptr<EmulatedServo> servo = servo_of(params.driver, faults);
  Transcript heard;
  std::int64_t now_ns = kStart_ns;
  const auto run_until = [&](std::int64_t end_ns) {
    for (; now_ns < end_ns; now_ns += kMs) {
      servo->tick(now_ns);
      for (const ServoFrame& frame : servo->take_output()) {
        EXPECT_EQ(::write(far.get(), frame.data(), frame.size()), static_cast<ssize_t>(frame.size()));
      }
      source.work(ManualClock(now_ns), heard);
      std::array<std::byte, 256> bytes{};
      for (ssize_t size = 0; (size = ::read(far.get(), bytes.data(), bytes.size())) > 0;) {
        servo->receive(std::span(bytes).first(static_cast<std::size_t>(size)), now_ns);
      }
      heard.note(fmt::format("{} {}", source.was_level_since(now_ns), source.report().obeys));
    }
  };
  run_until(kStart_ns + duration_ns);
  source.end(now_ns);
  run_until(now_ns + 300 * kMs);
  heard.note(fmt::format("left at {} rad", servo->angle_rad()));
  return heard.text();
}

Scene servo_with(const std::string& name, const std::string& toml, const std::string& fault = "") {
  std::vector<Fault> faults;
  if (!fault.empty()) {
    faults = {parse_fault(fault)};
  }
  return {name, {"[tilt]\n" + toml}, [faults](const DaemonParams& params) {
            return served(params.tilt, faults, 3 * kSecond);
          }};
}

/// Which line is opened, where there is one.
std::string opened(const DaemonParams& params) {
  const Result<FileDescriptor> line = open_tilt_line(params.tilt);
  return fmt::format("{}: {}", params.tilt.device, line.ok() ? "open" : describe(line.error()));
}

std::vector<Scene> all_tilt_scenes() {
  const std::string wide = "at_start = \"sweep\"\nsweep_from_deg = -50\nsweep_to_deg = 50\nspeed_degps = 120\n";
  return {{"opening", {"[tilt]\ndriver = \"dynamixel\"\ndevice = \"/dev/null\"\n"}, opened},
          servo_with("dynamixel", "driver = \"dynamixel\"\n" + wide),
          servo_with("cia402", "driver = \"cia402\"\n" + wide),
          servo_with("cia402 homing", "driver = \"cia402\"\nhoming_method = 17\n"),
          servo_with("maestro", "driver = \"maestro\"\n" + wide),
          servo_with("dynamixel silent", "driver = \"dynamixel\"\n", "silence@1:20"),
          servo_with("dynamixel jammed", "driver = \"dynamixel\"\n" + wide, "stall@1:20")};
}

}  // namespace

KeyClass tilt_class() { return {"tilt", {"tilt."}, all_tilt_scenes}; }

}  // namespace odoless::test
