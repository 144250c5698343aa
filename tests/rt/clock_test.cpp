// What every clock promises, over every clock; then each by itself.
#include "rt/clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <memory>
#include <ostream>

#include "rt/cpu_clock.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

struct ClockCase {
  const char* name;
  std::unique_ptr<Clock> (*make)();

  friend void PrintTo(const ClockCase& clock_case, std::ostream* out) { *out << clock_case.name; }
};

/// How long the quickest of a few tries takes: whatever else the machine does makes them slower, never quicker.
template <class Act>
std::int64_t quickest_ns(const Act& act) {
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 5; ++i) {
    const std::int64_t start_ns = monotonic_ns();
    act();
    least_ns = std::min(least_ns, monotonic_ns() - start_ns);
  }
  return least_ns;
}

class ClockContract : public ::testing::TestWithParam<ClockCase> {};

TEST_P(ClockContract, IsAtTheStampThatWasSleptForOrLater) {
  const auto clock = GetParam().make();
  std::int64_t wanted_ns = clock->now_ns();
  std::int64_t least_late_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 10; ++i) {
    wanted_ns += i * kMs / 4;
    clock->sleep_until(wanted_ns);
    const std::int64_t late_ns = clock->now_ns() - wanted_ns;
    ASSERT_GE(late_ns, 0);
    least_late_ns = std::min(least_late_ns, late_ns);
  }
  EXPECT_LT(least_late_ns, 1'000 * kMs);
}

TEST_P(ClockContract, NeverRunsBackwards) {
  const auto clock = GetParam().make();
  std::int64_t last_ns = clock->now_ns();
  for (const std::int64_t step_ns : {0, 1000, -5000, 300, -100'000'000, 0, 1}) {
    clock->sleep_until(last_ns + step_ns);
    ASSERT_GE(clock->now_ns(), last_ns);
    last_ns = clock->now_ns();
  }
}

TEST_P(ClockContract, ReturnsAtOnceFromAStampThatHasPassed) {
  const auto clock = GetParam().make();
  clock->sleep_until(clock->now_ns() + kMs);
  const std::int64_t least_ns = quickest_ns([&] {
    clock->sleep_until(clock->now_ns() - 3'600'000 * kMs);
    clock->sleep_until(0);
    clock->sleep_until(-kMs);
  });
  EXPECT_LT(least_ns, 500 * kMs);
}

INSTANTIATE_TEST_SUITE_P(
    AllClocks, ClockContract,
    ::testing::Values(
        ClockCase{"monotonic", []() -> std::unique_ptr<Clock> { return std::make_unique<MonotonicClock>(); }},
        ClockCase{"manual", []() -> std::unique_ptr<Clock> { return std::make_unique<ManualClock>(1'000); }},
        ClockCase{"replay_fast", []() -> std::unique_ptr<Clock> { return std::make_unique<ReplayClock>(0.0); }},
        ClockCase{"replay_at_pace", []() -> std::unique_ptr<Clock> { return std::make_unique<ReplayClock>(1.0); }}),
    [](const auto& case_info) { return case_info.param.name; });

TEST(MonotonicClock, CountsFromTheUnixEpoch) {
  const std::int64_t epoch_s = std::time(nullptr);
  EXPECT_NEAR(static_cast<double>(MonotonicClock().now_ns()) / 1e9, static_cast<double>(epoch_s), 5.0);
}

TEST(MonotonicClock, SleepsInRealTime) {
  MonotonicClock clock;
  const std::int64_t start_ns = monotonic_ns();
  clock.sleep_until(clock.now_ns() + 20 * kMs);
  EXPECT_GE(monotonic_ns() - start_ns, 20 * kMs);
}

TEST(ManualClock, StandsStillUntilMoved) {
  ManualClock clock(5);
  EXPECT_EQ(clock.now_ns(), 5);
  clock.advance_to(9);
  clock.advance_to(7);
  clock.advance_by(2);
  EXPECT_EQ(clock.now_ns(), 11);
  clock.sleep_until(20);
  EXPECT_EQ(clock.now_ns(), 20);
}

constexpr std::int64_t kLog_ns = 1'300'000'000'000'000'000;  // a stamp of a log

TEST(ReplayClock, IsExactlyAtTheStampsOfTheLog) {
  for (const double rate : {0.0, 1000.0}) {
    ReplayClock clock(rate);
    for (int i = 0; i < 100; ++i) {
      clock.sleep_until(kLog_ns + i * kMs);
      ASSERT_EQ(clock.now_ns(), kLog_ns + i * kMs);
    }
  }
}

TEST(ReplayClock, KeepsTheRateAfterTheFirstStamp) {
  for (const double rate : {1.0, 4.0}) {
    const std::int64_t least_ns = quickest_ns([rate] {
      ReplayClock clock(rate);
      clock.sleep_until(kLog_ns);
      clock.sleep_until(kLog_ns + 40 * kMs);
    });
    const std::int64_t wanted_ns = static_cast<std::int64_t>(40 * kMs / rate);
    EXPECT_GE(least_ns, wanted_ns);
    EXPECT_LT(least_ns, wanted_ns + 500 * kMs);
  }
}

TEST(ReplayClock, OfRateZeroDoesNotSleep) {
  const std::int64_t least_ns = quickest_ns([] {
    ReplayClock clock(0.0);
    clock.sleep_until(kLog_ns);
    clock.sleep_until(kLog_ns + 3'600'000 * kMs);
  });
  EXPECT_LT(least_ns, 500 * kMs);
}

}  // namespace
}  // namespace odoless
