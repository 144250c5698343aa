// What `odoless emulate robot` and `gpio` are made of, without lines: recorded bytes played again, and a robot's wires.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bot_core/raw_t.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "drivers/io/candump_text.hpp"
#include "firmware/gpio/gpio_recorder.hpp"
#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/log_writer.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/servo_support.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/times.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/emulated_gpio.hpp"
#include "tools/emulate/raw_player.hpp"
#include "tools/emulate/recorded_gpio.hpp"
#include "tools/emulate/traced_servo.hpp"
#include "tools/emulate/world_source.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using test::kMs;
constexpr std::int64_t kNeverNs = std::numeric_limits<std::int64_t>::max();

/// A drive and a session on a bus for some seconds, each millisecond; what the session hears, and what both say.
template <class Receive, class Take>
std::vector<double> angles_of(const Receive& to_drive, const Take& from_drive, std::vector<RawPiece>* record) {
  TiltParams params = test::servo_params(TiltDriver::kCia402);
  params.at_start = TiltCommand::kSweep;
  const auto session = make_tilt_session(params);
  test::HeardTilt heard;
  const auto keep = [&](std::int64_t now_ns, bool to_device, std::span<const std::byte> bytes) {
    if (record != nullptr) {
      record->push_back({now_ns / 1000, to_device, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
    }
  };
  session->reset(0);
  for (std::int64_t now_ns = 0; now_ns < 5000 * kMs; now_ns += kMs) {
    for (const ServoFrame& frame : from_drive(now_ns)) {
      keep(now_ns, false, frame);
      session->receive(frame, now_ns, heard);
    }
    session->tick(now_ns, heard);
    for (auto frame = session->transmit(); !frame.empty(); frame = session->transmit()) {
      keep(now_ns, true, frame);
      to_drive(frame, now_ns);
    }
  }
  std::vector<double> angles_rad;
  for (const TiltSample& sample : heard.samples) {
    angles_rad.push_back(sample.angle_rad);
  }
  return angles_rad;
}

TEST(RawPlayer, ARecordedDriveIsBroughtUpAgainAndGivesTheSameAngles) {
  const auto drive = test::ServoBench::make_servo(test::servo_params(TiltDriver::kCia402), {});
  std::vector<RawPiece> record;
  const std::vector<double> first =
      angles_of([&](std::span<const std::byte> frame, std::int64_t now_ns) { drive->receive(frame, now_ns); },
                [&](std::int64_t now_ns) {
                  drive->tick(now_ns);
                  return drive->take_output();
                },
                &record);
  RawPlayer player(record, sizeof(CanFrame));
  const std::vector<double> second = angles_of(
      [&](std::span<const std::byte> frame, std::int64_t now_ns) {
        player.receive({reinterpret_cast<const char*>(frame.data()), frame.size()}, now_ns);
      },
      [&](std::int64_t now_ns) {
        std::vector<ServoFrame> frames;
        for (const std::string& piece : player.take_due(now_ns)) {
          const auto bytes = std::as_bytes(std::span(piece.data(), piece.size()));
          frames.emplace_back(bytes.begin(), bytes.end());
        }
        return frames;
      },
      nullptr);
  EXPECT_GT(first.size(), 300U);
  EXPECT_EQ(second, first);
  EXPECT_EQ(player.counts().unknown, 0);
  EXPECT_EQ(player.counts().repeated, 0);
}

/// Records bytes of a device as the daemon does.
void record(LogWriter& writer, const std::string& channel, std::int64_t stamp_us, std::string_view bytes) {
  bot_core::raw_t raw{};
  raw.utime = stamp_us;
  raw.length = static_cast<std::int32_t>(bytes.size());
  raw.data.assign(bytes.begin(), bytes.end());
  std::vector<std::byte> message(static_cast<std::size_t>(raw.getEncodedSize()));
  ASSERT_GT(raw.encode(message.data(), 0, raw.getEncodedSize()), 0);
  writer.record(channel, message, stamp_us * 1000);
}

std::string candump(const CanFrame& frame) {
  std::array<char, kCandumpTextMax> buffer{};
  return std::string(candump_text(1'700'000'000'123'456, "can0", frame, buffer)) + '\n';
}

TEST(RawRecording, TellsTheDevicesApartAndReadsFramesOfCan) {
  const test::TemporaryFolder folder;
  const Channels channels("ROBOT7_");
  const CanFrame command{.id = 0x601, .size_bytes = 2, .data = {0x40, 0}};
  const CanFrame status{.id = 0x181, .size_bytes = 1, .data = {0x37}};
  {
    LogWriter writer({.path = (folder.path() / "run").string()});
    record(writer, channels.lrf_raw_tx, 10, "VV\n");
    record(writer, channels.lrf_raw_rx, 20, std::string_view("\0\xff", 2));
    record(writer, channels.tilt_raw_tx, 30, candump(command));
    record(writer, channels.tilt_raw_rx, 31, candump({.id = 0x080}));  // the bus's echo
    record(writer, channels.tilt_raw_rx, 40, candump(status));
    record(writer, channels.scan, 50, "no raw_t");
  }
  const RawRecording recording = read_raw_recording(folder.path() / "run.00000.lcm");
  ASSERT_EQ(recording.laser.size(), 2U);
  EXPECT_TRUE(recording.laser[0].to_device);
  EXPECT_EQ(recording.laser[0].bytes, "VV\n");
  EXPECT_EQ(recording.laser[1].bytes, std::string("\0\xff", 2));
  EXPECT_EQ(recording.laser[1].time_us, 20);
  ASSERT_EQ(recording.servo.size(), 2U);
  EXPECT_TRUE(recording.servo_is_on_can);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto frame = to_can_frame(std::as_bytes(std::span(recording.servo[i].bytes)));
    ASSERT_TRUE(frame);
    EXPECT_EQ(*frame, i == 0 ? command : status);
  }
}

// A heartbeat, or a SYNC, between a question and its answer must not become what is answered.
TEST(RawRecording, PutsEachAnswerOfABusBehindItsQuestion) {
  const test::TemporaryFolder folder;
  const Channels channels;
  {
    LogWriter writer({.path = (folder.path() / "run").string()});
    record(writer, channels.tilt_raw_tx, 10, candump({.id = 0x601, .size_bytes = 8}));
    record(writer, channels.tilt_raw_tx, 11, candump({.id = 0x77F, .size_bytes = 1}));
    record(writer, channels.tilt_raw_tx, 12, candump({.id = 0x201, .size_bytes = 6}));
    record(writer, channels.tilt_raw_tx, 13, candump({.id = 0x080}));
    record(writer, channels.tilt_raw_rx, 14, candump({.id = 0x701, .size_bytes = 1}));
    record(writer, channels.tilt_raw_rx, 15, candump({.id = 0x581, .size_bytes = 8}));
    record(writer, channels.tilt_raw_rx, 16, candump({.id = 0x181, .size_bytes = 7}));
  }
  std::vector<std::uint32_t> ids;
  for (const RawPiece& piece : read_raw_recording(folder.path() / "run.00000.lcm").servo) {
    ids.push_back(to_can_frame(std::as_bytes(std::span(piece.bytes)))->id);
  }
  EXPECT_THAT(ids, ElementsAre(0x601, 0x581, 0x080, 0x701, 0x181));
}

TEST(RawRecording, RefusesALogWithoutBytesOrWithDamagedOnes) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_raw_recording(folder.path() / "none.lcm")), NoInputError);
  {
    LogWriter writer({.path = (folder.path() / "run").string()});
    writer.record("ODOLESS_LRF_RAW_RX", std::as_bytes(std::span("damaged", 7)), 1000);
  }
  EXPECT_THROW(static_cast<void>(read_raw_recording(folder.path() / "run.00000.lcm")), DataError);
}

RawPiece wire_change(std::int64_t time_ms, const char* text) { return {time_ms * 1000, false, text}; }

/// When each input changes, in ms: "s" and "S" are the stop's falling and rising edge, "p" and "P" the pulse's.
std::string changes_of(RobotWires& wires, std::int64_t step_ms, std::int64_t end_ms) {
  std::string seen;
  bool stop = wires.is_high(GpioPin::kStop);
  bool sync = wires.is_high(GpioPin::kSync);
  for (std::int64_t now_ms = 0; now_ms <= end_ms; now_ms += step_ms) {
    for (bool again = true; again; again = wires.next_event_ns() <= now_ms * kMs) {
      wires.tick(now_ms * kMs);
      const auto note = [&](GpioPin pin, bool& was_high, const char* names) {
        if (wires.is_high(pin) != was_high) {
          was_high = !was_high;
          seen += std::to_string(now_ms) + names[was_high ? 1 : 0] + ' ';
        }
      };
      note(GpioPin::kStop, stop, "sS");
      note(GpioPin::kSync, sync, "pP");
    }
  }
  return seen;
}

TEST(RecordedGpio, PlaysStopAndPulsesWhenTheyAreDueAndNeverLosesAStop) {
  const std::vector<RawPiece> pieces{
      wire_change(0, "stop high\n"),  wire_change(0, "sync low\n"),   wire_change(10, "sync high\n"),
      wire_change(12, "sync low\n"),  wire_change(13, "power low\n"), wire_change(14, "stop low\n"),
      wire_change(15, "stop high\n"), wire_change(16, "stop lost\n"), wire_change(20, "sync high\n"),
      wire_change(22, "sync low\n"),  wire_change(30, "sync high\n")};
  const auto at_once = [](std::int64_t recorded_us) { return recorded_us * 1000; };
  RecordedGpio punctual(pieces, at_once, "x.lcm");
  EXPECT_EQ(changes_of(punctual, 1, 40), "10P 12p 14s 15S 20P 22p 30P ");
  EXPECT_EQ(punctual.played(), punctual.recorded());
  RecordedGpio held_up(pieces, at_once, "x.lcm");
  EXPECT_EQ(changes_of(held_up, 25, 50), "25s 25S 50P ") << "pulses that are over when they are looked at are left out";
  RecordedGpio never(
      pieces, [](std::int64_t) { return kNeverNs; }, "x.lcm");
  EXPECT_EQ(changes_of(never, 1, 40), "");
  EXPECT_EQ(never.next_event_ns(), kNeverNs);
}

// The daemon's own way: from its GPIO thread's recorder through the publisher's link into a log, and out of it again.
TEST(RecordedGpio, WhatTheDaemonRecordsIsPlayedWithTheLaser) {
  const test::TemporaryFolder folder;
  Outbox outbox(1 << 14);
  GpioRecorder recorder(outbox);
  recorder.on_level(GpioPin::kStop, GpioLevel::kHigh, 1000 * kMs);
  recorder.on_level(GpioPin::kSync, GpioLevel::kLow, 1000 * kMs);
  recorder.on_level(GpioPin::kPower, GpioLevel::kHigh, 1001 * kMs);
  for (const std::int64_t turn_ms : {1025, 1050, 1075}) {
    recorder.on_edge(GpioPin::kSync, true, turn_ms * kMs);
    recorder.on_edge(GpioPin::kSync, false, (turn_ms + 2) * kMs);
  }
  recorder.on_edge(GpioPin::kStop, false, 1080 * kMs);
  {
    LogWriter writer({.path = (folder.path() / "run").string()});
    LcmParams lcm;
    lcm.url = "";
    LcmLink link(lcm, 1);
    link.set_tap(&writer);
    record(writer, Channels().lrf_raw_tx, 1'010'000, "MD\n");
    for (auto front = outbox.ring().front(); front; front = outbox.ring().front()) {
      ASSERT_EQ(
          link.publish(record_of<RawBytesRecord>(front->bytes), elements_of<std::byte, RawBytesRecord>(front->bytes)),
          Errc::kOk);
      outbox.ring().pop();
    }
  }
  const auto path = folder.path() / "run.00000.lcm";
  const RawRecording recording = read_raw_recording(path);
  EXPECT_EQ(recording.gpio.size(), 10U);
  RawPlayer laser(recording.laser);
  RecordedGpio wires(
      recording.gpio, [&](std::int64_t recorded_us) { return laser.due_ns(recorded_us); }, path);
  EXPECT_EQ(changes_of(wires, 1, 50), "") << "the laser has not been spoken to";
  laser.receive("MD\n", 100 * kMs);  // recorded at 1010 ms
  EXPECT_EQ(changes_of(wires, 1, 300), "115P 117p 140P 142p 165P 167p 170s ");
}

TEST(EmulateRobot, RefusesWhatMakesNoSense) {
  EXPECT_THAT(test::run({"emulate", "robot", "--pty", "x"}).err, HasSubstr("--from WORLD|LOG"));
  EXPECT_THAT(test::run({"emulate", "robot", "--from", "x.world"}).err, HasSubstr("--pty, --tcp and --usbip"));
  EXPECT_EQ(test::run({"emulate", "robot", "--from", "x.world", "--from-raw", "y", "--pty", "z"}).status, 64);
  EXPECT_THAT(test::run({"emulate", "gpio", "--fault", "garbage@1"}).err, HasSubstr("not of GPIO lines"));
}

/// Turns by 1 rad/s from 0.
class TurningServo final : public EmulatedServo {
 public:
  void receive(std::span<const std::byte> /*bytes*/, std::int64_t now_ns) override { tick(now_ns); }
  void tick(std::int64_t now_ns) override { angle_rad_ = static_cast<double>(now_ns) * 1e-9; }
  [[nodiscard]] std::int64_t next_event_ns() const override { return kNeverNs; }
  [[nodiscard]] std::vector<ServoFrame> take_output() override { return {}; }
  [[nodiscard]] double angle_rad() const override { return angle_rad_; }
  [[nodiscard]] double velocity_radps() const override { return 1.0; }

 private:
  double angle_rad_ = 0.0;
};

TEST(TracedServo, KnowsWhereItsAxisHasBeen) {
  TracedServo servo(std::make_unique<TurningServo>());
  servo.tick(100 * kMs);
  servo.receive({}, 300 * kMs);
  EXPECT_NEAR(servo.angle_rad_at(100 * kMs), 0.1, 1e-12);
  EXPECT_NEAR(servo.angle_rad_at(250 * kMs), 0.25, 1e-12) << "between two looks";
  EXPECT_NEAR(servo.angle_rad_at(310 * kMs), 0.31, 1e-12) << "not yet looked at: time passes until then";
  EXPECT_NEAR(servo.angle_rad(), 0.31, 1e-12);
}

TEST(TiltedWorldSource, SeesFloorAndWallsEachBeamAtItsOwnTilt) {
  WorldDrive drive{.world = parse_world("ceiling 2.5\nroom 0 0  8 6\ngo 2 3  4 3\n", "room"),
                   .start_delay_s = 100.0,
                   .noise_sd_m = 0.0,
                   .distortion = true};
  WorldSource source(25 * kMs, std::move(drive));
  const TiltMountParams mount{.robot_T_tilt = {.z_m = 0.6}};
  const double floor_rad = 30.0 * test::kRadPerDeg;
  const double wall_rad = 2.0 * test::kRadPerDeg;
  source.tilt({TiltMount(mount), [&](std::int64_t time_ns) { return time_ns < 10 * kMs ? floor_rad : wall_rad; }});
  const std::vector<EmulatedBeam> beams{{0.0, 1 * kMs}, {0.0, 20 * kMs}};
  std::vector<double> ranges_m(2);
  source.measure(0, beams, ranges_m);
  EXPECT_NEAR(ranges_m[0], 0.6 / std::sin(floor_rad), 1e-9);
  EXPECT_NEAR(ranges_m[1], 6.0 / std::cos(wall_rad), 1e-9);
}

TEST(EmulateRobot, TiltsNothingWithoutAServoOrAWorld) {
  const test::TemporaryFolder folder;
  const std::string config = folder.file("robot.toml", "").string();
  const std::string world = folder.file("room.world", "room 0 0  8 6\ngo 2 3  4 3\n").string();
  const test::Outcome none =
      test::run({"emulate", "robot", "--from", world, "--pty", (folder.path() / "laser").string(), "--config", config});
  EXPECT_EQ(none.status, 64);
  EXPECT_THAT(none.err, HasSubstr("--servo-pty"));
}

}  // namespace
}  // namespace odoless
