#include <gtest/gtest.h>

#include <set>
#include <string>

#include "firmware/gpio/gpio_thread.hpp"
#include "firmware/gpio/laser_power.hpp"
#include "firmware/gpio/status_light.hpp"

// With lines that are there: tests/hil/gpio_test.py.
namespace odoless {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(LaserPower, StaysOnWhileScansCome) {
  LaserPower power(10 * kSecond_ns, kSecond_ns, 0);
  for (std::int64_t now_ns = 0; now_ns < 100 * kSecond_ns; now_ns += kSecond_ns / 10) {
    ASSERT_TRUE(power.update(now_ns, now_ns - 5 * kSecond_ns));
  }
  EXPECT_EQ(power.cycles(), 0);
}

TEST(LaserPower, IsOffForItsTimeAfterSilenceAgainAndAgain) {
  LaserPower power(10 * kSecond_ns, kSecond_ns, 0);
  std::string seen;
  for (std::int64_t second = 0; second < 26; ++second) {
    seen += power.update(second * kSecond_ns, 2 * kSecond_ns) ? '1' : '0';
  }
  EXPECT_EQ(seen, "11111111111101111111111011");  // off from 12 s and, as it is on again from 13 s, from 23 s
  EXPECT_EQ(power.cycles(), 2);
}

std::string pattern(HealthState state, bool stopped) {
  std::string pattern;
  for (int i = 0; i < 20; ++i) {
    pattern += status_light_is_on(state, stopped, 14 * kSecond_ns + (i * 100 + 50) * 1'000'000LL) ? '#' : '.';
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

TEST(GpioThread, AStopLineThatIsNotThereIsAStop) {
  GpioParams params;
  params.stop_line = "odoless-no-such-line";
  GpioSignals signals;
  const MonotonicClock clock;
  const WakeUp wake;
  GpioThread thread(params, signals, clock, wake);
  EXPECT_TRUE(signals.stopped);
  EXPECT_EQ(thread.start(), 0);
  for (int i = 0; i < 10; ++i) {
    MonotonicClock().sleep_until(MonotonicClock().now_ns() + 20'000'000);
    EXPECT_TRUE(signals.stopped);
    EXPECT_TRUE(signals.line_lost);
  }
}

TEST(GpioThread, WithoutLinesNothingIsStoppedAndThereIsNoThread) {
  GpioSignals signals;
  const MonotonicClock clock;
  const WakeUp wake;
  GpioThread thread({}, signals, clock, wake);
  EXPECT_EQ(thread.start(), 0);
  EXPECT_FALSE(signals.stopped);
  EXPECT_FALSE(signals.line_lost);
}

}  // namespace
}  // namespace odoless
