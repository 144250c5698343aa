// The daemon's side of a servo, against emulated ones on a socket instead of their line, in made-up time.
#include "firmware/sources/tilt_source.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "firmware/sources/tilt_event_text.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::servo_params;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class TiltBench final : public ScanSink {
 public:
  TiltBench(const TiltParams& params, std::unique_ptr<EmulatedServo> servo)
      : source_(params, line_), servo_(std::move(servo)) {
    int ends[2]{-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends), 0);
    far_ = FileDescriptor(ends[0]);
    near_ = FileDescriptor(ends[1]);
    line_.offer(near_.get());
    gpio_.has_stop_line = true;
    source_.obey_stop(gpio_);
  }
  explicit TiltBench(const TiltParams& params, const std::string& fault = "")
      : TiltBench(params, test::ServoBench::make_servo(
                              params, fault.empty() ? std::vector<Fault>() : std::vector<Fault>{parse_fault(fault)})) {}

  void on_scan(const RawScan& /*scan*/) override {}
  void on_motion(const Motion& /*motion*/) override {}
  void on_raw(RawLine /*line*/, std::span<const std::byte> /*bytes*/, bool /*to_device*/) override {}
  void on_tilt(const TiltRecord& /*tilt*/) override {}
  void on_event(EventPriority /*priority*/, EventText text, std::int64_t number) override {
    log.push_back(fmt::format(fmt::runtime(fmt::string_view(text)), number));
  }

  /// A millisecond at a time.
  void run(
      std::int64_t duration_ns, const std::function<void()>& after_each = [] {}) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kServoMs) {
      gpio_.round_ns = gpio_hangs ? gpio_.round_ns.load() : now_ns_;
      step();
      after_each();
    }
  }

  [[nodiscard]] TiltSource& source() { return source_; }
  [[nodiscard]] EmulatedServo& servo() { return *servo_; }
  [[nodiscard]] GpioSignals& gpio() { return gpio_; }
  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }

  bool gpio_hangs = false;
  std::vector<std::string> log;
  std::function<void(ServoFrame&)> to_source = [](ServoFrame&) {};

 private:
  void step() {
    servo_->tick(now_ns_);
    for (ServoFrame& frame : servo_->take_output()) {
      to_source(frame);
      EXPECT_EQ(::write(far_.get(), frame.data(), frame.size()), static_cast<ssize_t>(frame.size()));
    }
    source_.work(ManualClock(now_ns_), *this);
    std::array<std::byte, 256> bytes{};
    for (ssize_t size = 0; (size = ::read(far_.get(), bytes.data(), bytes.size())) > 0;) {
      servo_->receive(std::span(bytes).first(static_cast<std::size_t>(size)), now_ns_);
    }
  }

  LineHandover line_;
  GpioSignals gpio_;
  TiltSource source_;
  std::unique_ptr<EmulatedServo> servo_;
  FileDescriptor far_;
  FileDescriptor near_;
  std::int64_t now_ns_ = 1000 * kServoSecond;
};

class TiltSourceOfBoth : public ::testing::TestWithParam<TiltDriver> {
 protected:
  [[nodiscard]] static TiltParams params() { return servo_params(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Drivers, TiltSourceOfBoth, ::testing::Values(TiltDriver::kCia402, TiltDriver::kDynamixel),
                         [](const auto& about) {
                           return std::string(kTiltDriverNames[static_cast<int>(about.param)]);
                         });

TEST_P(TiltSourceOfBoth, StopsTheServoWithin200MsWhenTheStopLineIsNotReadAnyMore) {
  TiltParams sweeping = params();
  sweeping.at_start = TiltCommand::kSweep;
  for (const bool has_stop_line : {true, false}) {
    TiltBench bench(sweeping);
    bench.gpio().has_stop_line = has_stop_line;
    bench.run(2 * kServoSecond);
    while (std::abs(bench.servo().angle_rad()) > 0.1) {  // in the middle, so that it would go on for long
      bench.run(kServoMs);
    }
    ASSERT_GT(std::abs(bench.servo().velocity_radps()), 0.5);
    bench.gpio_hangs = true;
    bench.run(200 * kServoMs);
    EXPECT_EQ(std::abs(bench.servo().velocity_radps()) < 0.01, has_stop_line);
    bench.gpio_hangs = false;
    bench.run(200 * kServoMs);
    EXPECT_GT(std::abs(bench.servo().velocity_radps()), 0.5) << "goes on once the line is read again";
  }
}

/// A drive that is to find its zero, which is 0.4 rad off.
std::unique_ptr<EmulatedServo> drive_without_zero(const std::string& fault) {
  Cia402DeviceOptions options;
  options.home_rad = -0.4;
  options.faults = {parse_fault(fault)};
  return std::make_unique<Cia402Device>(options, 1000 * kServoSecond);
}

TEST(TiltSource, IsNotLevelFromTheFirstMoveTowardsTheZeroUntilItHasComeToLevel) {
  TiltParams params = servo_params(TiltDriver::kCia402);
  params.homing_method = 17;
  TiltBench bench(params, drive_without_zero("reboot@12"));
  bool has_moved = false;
  int level = 0;
  bench.run(24 * kServoSecond, [&] {
    const bool moves = std::abs(bench.servo().velocity_radps()) > 0.05;
    has_moved = has_moved || moves;
    const bool is_level = bench.source().was_level_since(bench.now_ns());
    ASSERT_FALSE(has_moved && is_level && (moves || std::abs(bench.servo().angle_rad()) > 0.02))
        << "at " << bench.servo().angle_rad() << " rad";
    level += is_level ? 1 : 0;
  });
  EXPECT_TRUE(bench.source().was_level_since(bench.now_ns() - 25 * kServoMs));
  EXPECT_GT(level, 10'000);
}

TEST(TiltSource, IsTakenForLevelWhileItWaitsForLeaveToFindItsZero) {
  TiltParams params = servo_params(TiltDriver::kCia402);
  params.homing_method = 17;
  params.at_start = TiltCommand::kStop;
  TiltBench bench(params);
  bench.run(2 * kServoSecond, [&] { ASSERT_TRUE(bench.source().was_level_since(bench.now_ns())); });
  bench.source().request(TiltCommand::kLevel);
  bench.run(100 * kServoMs);
  EXPECT_FALSE(bench.source().was_level_since(bench.now_ns()));
  EXPECT_FALSE(bench.source().was_level_since(bench.now_ns() - kServoSecond));
}

TEST_P(TiltSourceOfBoth, LeavesTheServoAsConfiguredAndWhereItIsWhileTheStopLineIsPressed) {
  TiltParams sweeping = params();
  sweeping.at_start = TiltCommand::kSweep;
  sweeping.at_end = TiltEnd::kLevel;
  for (const bool stopped : {false, true}) {
    TiltBench bench(sweeping);
    bench.run(2 * kServoSecond);
    while (std::abs(bench.servo().angle_rad()) < 0.2) {
      bench.run(kServoMs);
    }
    EXPECT_FALSE(bench.source().has_ended());
    bench.gpio_hangs = stopped;
    bench.run(stopped ? 200 * kServoMs : kServoMs);
    const double angle_rad = bench.servo().angle_rad();
    bench.source().end(bench.now_ns());
    bench.run(200 * kServoMs);
    EXPECT_TRUE(bench.source().has_ended());
    bench.run(3 * kServoSecond);
    EXPECT_NEAR(bench.servo().angle_rad(), stopped ? angle_rad : 0.0, 0.01);
  }
}

TEST_P(TiltSourceOfBoth, SaysOnceThatTheServoDoesNotAnswerAndAgainAfterItHas) {
  TiltBench bench(params(), "silence@3:20");
  bench.run(30 * kServoSecond);
  EXPECT_THAT(bench.log, ElementsAre("tilt servo: set up, obeys",
                                     AllOf(HasSubstr("it does not answer"), HasSubstr("power"), HasSubstr("tilt.id")),
                                     "tilt servo: set up, obeys"));
}

TEST(TiltSource, NamesTheObjectThatADriveRefusesAndNotAtEachAttempt) {
  TiltBench bench(servo_params(TiltDriver::kCia402));
  bench.to_source = [](ServoFrame& frame) {
    CanFrame reply = *to_can_frame(frame);
    if (reply.id == 0x581 && canopen::get(reply, 1, 2) == 0x6081) {
      reply.data[0] = 0x80;
      canopen::put(reply, 4, 0x06090030, 4);
      frame = ServoFrame(as_bytes(reply).begin(), as_bytes(reply).end());
    }
  };
  bench.run(50 * kServoSecond);
  EXPECT_THAT(bench.log, ElementsAre(AllOf(HasSubstr("object 608100h"), HasSubstr("out of its range")),
                                     HasSubstr("tilt servo: lost: it has an error")));
  bench.run(50 * kServoSecond);
  EXPECT_EQ(bench.log.size(), 3U) << "once a minute";
}

std::string line_of(const TiltEvent& event) {
  const TiltEventText said = text_of(event);
  return fmt::format(fmt::runtime(fmt::string_view(said.text)), said.number);
}

TEST(TiltEventText, TellsWhatIsRefusedAndWhy) {
  TiltEvent event{.type = TiltEventType::kDeviceError, .error = TiltError::kAbort, .code = 0x06020000};
  event.object = 0x60FE01;
  EXPECT_EQ(line_of(event), "tilt servo: it refuses object 60FE01h: it has no such object");
  event.code = 0x12345678;
  EXPECT_EQ(line_of(event), "tilt servo: it refuses an object: 60FE0112345678h (index, sub-index, abort code)");
  event = {.type = TiltEventType::kDeviceError, .error = TiltError::kErrorNumber, .code = 0x86, .object = 48};
  EXPECT_THAT(line_of(event), AllOf(HasSubstr("address 48:"), HasSubstr("limits")));
}

TEST(TiltEventText, BlamesTheConfigurationOnlyForWhatItSays) {
  TiltEvent event{.type = TiltEventType::kDeviceError, .error = TiltError::kAbort, .code = 0x06090030};
  event.object = 0x608100;
  EXPECT_THAT(line_of(event), AllOf(HasSubstr("object 608100h"), HasSubstr("tilt.speed_degps")));
  for (const std::uint32_t object : {0x605A00U, 0x600700U, 0x101601U, 0x180002U, 0x606000U}) {
    event.object = object;
    EXPECT_THAT(line_of(event), AllOf(HasSubstr("out of its range"), ::testing::Not(HasSubstr("tilt."))));
  }
}

TEST(TiltSource, SaysWhatADriveCannotDoByItselfAndUsesItAllTheSame) {
  TiltBench bench(servo_params(TiltDriver::kCia402));
  bench.to_source = [](ServoFrame& frame) {
    CanFrame reply = *to_can_frame(frame);
    const std::uint32_t object = canopen::get(reply, 1, 2);
    if (reply.id == 0x581 && (object == 0x605A || object == 0x6007 || object == 0x1016)) {
      reply.data[0] = 0x80;
      canopen::put(reply, 4, object == 0x1016 ? 0x06040043 : 0x06090030, 4);
      frame = ServoFrame(as_bytes(reply).begin(), as_bytes(reply).end());
    }
  };
  bench.run(3 * kServoSecond);
  EXPECT_THAT(bench.log,
              ElementsAre(HasSubstr("1016h"), HasSubstr("6007h"), HasSubstr("605Ah"), "tilt servo: set up, obeys"));
}

TEST(TiltSource, SaysWhichHardwareErrorAServoHas) {
  TiltBench bench(servo_params(TiltDriver::kDynamixel), "error=32@2:1");
  bench.run(6 * kServoSecond);
  EXPECT_THAT(bench.log, ::testing::Contains(AllOf(HasSubstr("hardware error 20h"), HasSubstr("20h overload"))));
}

TEST_P(TiltSourceOfBoth, CountsAnswersThatAreWrongOrMissingAndSaysSo) {
  TiltBench bench(params(), "wrong-sum@3:0.1");
  bench.run(2900 * kServoMs);
  EXPECT_EQ(bench.source().report().refused, 0);
  bench.run(130 * kServoMs);
  EXPECT_GE(bench.source().report().refused, 1) << "within three samples";
  bench.run(3 * kServoSecond);
  EXPECT_THAT(bench.log, ::testing::Contains(HasSubstr("was refused")));
}

}  // namespace
}  // namespace odoless
