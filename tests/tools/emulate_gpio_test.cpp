// A robot's wires that aren't there, without a chip.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/times.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/emulated_gpio.hpp"
#include "tools/emulate/recorded_gpio.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;

using test::kMs;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

TEST(EmulatedGpio, PressesTheStopAndGivesPulses) {
  EmulatedGpio gpio(
      {parse_fault("stop@0.05:0.01")}, [](std::int64_t i) { return (100 + 25 * i) * kMs; }, 0);
  std::vector<std::int64_t> rising_ms;
  std::vector<std::int64_t> pressed_ms;
  bool was_high = false;
  for (std::int64_t now_ns = 0; now_ns < 160 * kMs; now_ns = gpio.next_event_ns()) {
    gpio.tick(now_ns);
    ASSERT_GT(gpio.next_event_ns(), now_ns);
    if (gpio.is_high(GpioPin::kSync) && !was_high) {
      rising_ms.push_back(now_ns / kMs);
    }
    was_high = gpio.is_high(GpioPin::kSync);
    if (!gpio.is_high(GpioPin::kStop)) {
      pressed_ms.push_back(now_ns / kMs);
    }
  }
  EXPECT_THAT(rising_ms, ElementsAre(100, 125, 150));
  EXPECT_THAT(pressed_ms, ElementsAre(50));
  EXPECT_EQ(gpio.pulses(), 3);
}

TEST(EmulatedGpio, LeavesOutPulsesThatAreLateOrSilenced) {
  EmulatedGpio gpio(
      {parse_fault("silence@0.2:0.05")}, [](std::int64_t i) { return 100 * i * kMs; }, 0);
  gpio.tick(150 * kMs);
  EXPECT_FALSE(gpio.is_high(GpioPin::kSync)) << "held up: the pulses of 0 and 100 ms are over";
  gpio.tick(200 * kMs);
  EXPECT_FALSE(gpio.is_high(GpioPin::kSync));
  gpio.tick(300 * kMs);
  EXPECT_TRUE(gpio.is_high(GpioPin::kSync));
  EXPECT_EQ(gpio.pulses(), 1);
}

RawPiece change(std::int64_t time_ms, const char* text) { return {time_ms * 1000, false, text}; }

TEST(RecordedGpio, BeginsAtTheFirstRecordedLevels) {
  const auto never = [](std::int64_t) { return kNever; };
  const RecordedGpio pressed({change(5, "stop low\n"), change(6, "sync high\n"), change(9, "stop high\n")}, never, "");
  EXPECT_FALSE(pressed.is_high(GpioPin::kStop));
  EXPECT_TRUE(pressed.is_high(GpioPin::kSync));
  const RecordedGpio nothing({}, never, "");
  EXPECT_TRUE(nothing.is_high(GpioPin::kStop));
  EXPECT_FALSE(nothing.is_high(GpioPin::kSync));
  EXPECT_THROW(RecordedGpio({change(0, "stop off\n")}, never, "x.lcm"), DataError);
}

}  // namespace
}  // namespace odoless
