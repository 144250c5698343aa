#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/gpio/gpio_change.hpp"
#include "firmware/gpio/gpio_recorder.hpp"
#include "firmware/gpio/gpio_thread.hpp"
#include "firmware/gpio/laser_power.hpp"
#include "firmware/gpio/status_light.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/times.hpp"

// With lines that are there: tests/hil/gpio_test.py.
namespace odoless {
namespace {

using test::kSecond;

TEST(LaserPower, StaysOnWhileScansCome) {
  LaserPower power(10 * kSecond, kSecond, 0);
  for (std::int64_t now_ns = 0; now_ns < 100 * kSecond; now_ns += kSecond / 10) {
    ASSERT_TRUE(power.update(now_ns, now_ns - 5 * kSecond));
  }
  EXPECT_EQ(power.cycles(), 0);
}

TEST(LaserPower, IsOffForItsTimeAfterSilenceAgainAndAgain) {
  LaserPower power(10 * kSecond, kSecond, 0);
  std::string seen;
  for (std::int64_t second = 0; second < 26; ++second) {
    seen += power.update(second * kSecond, 2 * kSecond) ? '1' : '0';
  }
  EXPECT_EQ(seen, "11111111111101111111111011");  // off from 12 s and, as it is on again from 13 s, from 23 s
  EXPECT_EQ(power.cycles(), 2);
}

std::string pattern(HealthState state, bool stopped) {
  std::string pattern;
  for (int i = 0; i < 20; ++i) {
    pattern += status_light_is_on(state, stopped, 14 * kSecond + (i * 100 + 50) * 1'000'000LL) ? '#' : '.';
  }
  return pattern;
}

TEST(StatusLight, HasAPatternOfItsOwnForEachState) {
  EXPECT_EQ(pattern(HealthState::kInit, false), "##########..........");
  EXPECT_EQ(pattern(HealthState::kOk, false), ".###################");
  EXPECT_EQ(pattern(HealthState::kDegraded, false), "#.#.................");
  EXPECT_EQ(pattern(HealthState::kLost, false), "#.#.#...............");
  EXPECT_EQ(pattern(HealthState::kFault, false), "#.#.#.#.#.#.#.#.#.#.");
  EXPECT_EQ(pattern(HealthState::kOk, true), "#.#.#.#.............");
}

TEST(GpioChange, IsTheSameAfterItsText) {
  for (std::size_t pin = 0; pin < kGpioPinNames.size(); ++pin) {
    for (std::size_t level = 0; level < kGpioLevelNames.size(); ++level) {
      const GpioChange change{static_cast<GpioPin>(pin), static_cast<GpioLevel>(level)};
      std::array<char, kGpioTextMax> buffer{};
      EXPECT_EQ(parse_gpio_text(gpio_text(change, buffer)), change);
    }
  }
  std::array<char, kGpioTextMax> buffer{};
  EXPECT_EQ(gpio_text({GpioPin::kStop, GpioLevel::kLow}, buffer), "stop low\n");
}

TEST(GpioChange, IsNotReadFromOtherText) {
  for (const char* const text :
       {"", "\n", "stop", "stop\n", "stop low", "stop low\n\n", "stop  low\n", "low stop\n", "stop LOW\n", " low\n"}) {
    EXPECT_EQ(parse_gpio_text(text), std::nullopt) << text;
  }
}

/// What was told, one after the other: when, which way, and what.
std::string told(Outbox& outbox) {
  std::string all;
  for (auto front = outbox.ring().front(); front; front = outbox.ring().front()) {
    const auto record = record_of<RawBytesRecord>(front->bytes);
    const auto bytes = elements_of<std::byte, RawBytesRecord>(front->bytes);
    EXPECT_EQ(front->type, static_cast<std::uint32_t>(RecordType::kRawBytes));
    EXPECT_EQ(record.line, RawLine::kGpio);
    EXPECT_EQ(static_cast<std::size_t>(record.size_bytes), bytes.size());
    all += std::to_string(record.stamp_ns) + (record.to_device == 0 ? " < " : " > ");
    all.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    outbox.ring().pop();
  }
  return all;
}

TEST(GpioRecorder, TellsEachEdgeAndWhatALevelHasBecome) {
  Outbox outbox(4096);
  GpioRecorder recorder(outbox);
  const AllocationGuard heap;
  recorder.on_level(GpioPin::kStop, GpioLevel::kHigh, 1);
  recorder.on_level(GpioPin::kStop, GpioLevel::kHigh, 2);
  recorder.on_edge(GpioPin::kStop, false, 3);
  recorder.on_edge(GpioPin::kStop, false, 4);  // the one between was dropped
  recorder.on_level(GpioPin::kStop, GpioLevel::kLow, 5);
  recorder.on_level(GpioPin::kPower, GpioLevel::kHigh, 6);
  recorder.on_level(GpioPin::kStop, GpioLevel::kLost, 7);
  recorder.on_level(GpioPin::kStop, GpioLevel::kLost, 8);
  EXPECT_EQ(heap.calls(), 0);
  EXPECT_EQ(told(outbox), "1 < stop high\n3 < stop low\n4 < stop low\n6 > power high\n7 < stop lost\n");
}

// The line changes after its edges were drained and before its level is read: the edge comes in the next round.
TEST(GpioRecorder, TellsAChangeOnceWhoseLevelWasReadBeforeItsEdgeCame) {
  Outbox outbox(4096);
  GpioRecorder recorder(outbox);
  recorder.on_level(GpioPin::kStop, GpioLevel::kHigh, 1);
  recorder.on_level(GpioPin::kStop, GpioLevel::kLow, 2);
  recorder.on_edge(GpioPin::kStop, false, 2);
  recorder.on_level(GpioPin::kStop, GpioLevel::kLow, 3);
  recorder.on_edge(GpioPin::kStop, true, 4);
  recorder.on_edge(GpioPin::kStop, false, 5);
  recorder.on_level(GpioPin::kStop, GpioLevel::kHigh, 6);
  recorder.on_edge(GpioPin::kStop, true, 6);
  EXPECT_EQ(told(outbox), "1 < stop high\n2 < stop low\n4 < stop high\n5 < stop low\n6 < stop high\n");
}

TEST(GpioThread, AStopLineThatIsNotThereIsAStop) {
  GpioParams params;
  params.stop_line = "odoless-no-such-line";
  GpioSignals signals;
  const MonotonicClock clock;
  const WakeUp wake;
  Outbox outbox(4096);
  GpioThread thread(params, signals, clock, wake, outbox);
  EXPECT_TRUE(signals.stopped);
  EXPECT_EQ(thread.start(), 0);
  const std::int64_t start_ns = clock.now_ns();
  for (int i = 0; i < 10; ++i) {
    MonotonicClock().sleep_until(MonotonicClock().now_ns() + 20'000'000);
    EXPECT_TRUE(signals.stopped);
    EXPECT_TRUE(signals.line_lost);
  }
  EXPECT_GT(signals.round_ns, start_ns) << "each round is told";
  EXPECT_TRUE(told(outbox).ends_with(" < stop lost\n"));
}

TEST(GpioThread, ARoundThatDoesNotEndIsAStop) {
  GpioSignals signals;
  signals.has_stop_line = true;
  signals.round_ns = 10 * kSecond;
  EXPECT_FALSE(signals.is_stopped(10 * kSecond + GpioSignals::kRoundMax_ns));
  EXPECT_TRUE(signals.is_stopped(10 * kSecond + GpioSignals::kRoundMax_ns + 1));
  signals.has_stop_line = false;  // only the light's line hangs
  EXPECT_TRUE(signals.is_silent(11 * kSecond));
  EXPECT_FALSE(signals.is_stopped(11 * kSecond));
}

TEST(GpioThread, WithoutLinesNothingIsStoppedAndThereIsNoThread) {
  GpioSignals signals;
  const MonotonicClock clock;
  const WakeUp wake;
  Outbox outbox(4096);
  GpioThread thread({}, signals, clock, wake, outbox);
  EXPECT_EQ(thread.start(), 0);
  EXPECT_FALSE(signals.is_stopped(clock.now_ns()));
  EXPECT_FALSE(signals.is_silent(clock.now_ns()));
  EXPECT_FALSE(signals.stopped);
  EXPECT_FALSE(signals.line_lost);
}

}  // namespace
}  // namespace odoless
