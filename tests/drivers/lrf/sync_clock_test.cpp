#include "drivers/lrf/sync_clock.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;
constexpr std::int64_t kTurn_ns = 25 * kMs;

TEST(SyncClock, PutsScansOnTheirPulses) {
  SyncClock clock(2 * kMs);
  for (int i = 0; i < 100; ++i) {
    const std::int64_t pulse_ns = 1'000'000'000 + i * kTurn_ns;
    clock.on_pulse(pulse_ns);
    if (i > 0) {
      const std::int64_t error_ns = (i % 11 - 5) * kMs;  // of the session's stamp, 6.25 ms at most
      EXPECT_EQ(clock.refine(pulse_ns + 2 * kMs + error_ns), pulse_ns + 2 * kMs) << i;
    }
  }
  EXPECT_EQ(clock.missed_in_a_row(), 0);
}

TEST(SyncClock, FindsThePulseOfAScanThatCameAFewTurnsLater) {
  SyncClock clock(0);
  for (int i = 0; i < 8; ++i) {
    clock.on_pulse(kTurn_ns * (i + 1));
  }
  EXPECT_EQ(clock.refine(3 * kTurn_ns + 4 * kMs), 3 * kTurn_ns);
}

TEST(SyncClock, LeavesAScanAloneWithoutAPulseThatFits) {
  SyncClock clock(0);
  EXPECT_EQ(clock.refine(5 * kMs), 5 * kMs) << "no pulse";
  clock.on_pulse(0);
  EXPECT_EQ(clock.refine(kMs), kMs) << "one pulse doesn't tell how long a turn is";
  clock.on_pulse(kTurn_ns);
  EXPECT_EQ(clock.refine(kTurn_ns + 7 * kMs), kTurn_ns + 7 * kMs) << "more than a quarter of a turn away";
  EXPECT_EQ(clock.missed_in_a_row(), 3);
  EXPECT_EQ(clock.refine(kTurn_ns + 6 * kMs), kTurn_ns);
  EXPECT_EQ(clock.missed_in_a_row(), 0);
  EXPECT_EQ(clock.refine(100 * kTurn_ns), 100 * kTurn_ns) << "the pulses have ended";
}

TEST(SyncClock, AMissingPulseCostsOneScanItsPulse) {
  SyncClock clock(0);
  for (int i = 1; i < 40; ++i) {
    if (i != 20) {
      clock.on_pulse(i * kTurn_ns);
    }
    const std::int64_t stamp_ns = i * kTurn_ns + 3 * kMs;
    EXPECT_EQ(clock.refine(stamp_ns), i == 1 || i == 20 ? stamp_ns : i * kTurn_ns) << i;
  }
}

TEST(SyncClock, APulseTooManyDoesNotPutTheOthersOut) {
  SyncClock clock(0);
  for (int i = 1; i < 40; ++i) {
    clock.on_pulse(i * kTurn_ns);
    if (i == 20) {
      clock.on_pulse(i * kTurn_ns + kMs / 10);  // a wire beside it
    }
    if (i > 1) {
      EXPECT_LE(clock.refine(i * kTurn_ns - 3 * kMs) - i * kTurn_ns, kMs / 10) << i;
      EXPECT_EQ(clock.missed_in_a_row(), 0) << i;
    }
  }
}

RC_GTEST_PROP(SyncClock, StampsStayInOrderAndNearWhateverThePulses, ()) {
  const auto pulses_ms = *rc::gen::container<std::vector<std::int64_t>>(rc::gen::inRange<std::int64_t>(0, 2000));
  SyncClock clock(0);
  std::size_t next = 0;
  std::int64_t last_ns = -1;
  for (int i = 1; i < 40; ++i) {
    while (next < pulses_ms.size() && pulses_ms[next] <= i * 25) {
      clock.on_pulse(pulses_ms[next++] * kMs);
    }
    const std::int64_t refined_ns = clock.refine(i * kTurn_ns);
    RC_ASSERT(refined_ns >= last_ns);
    last_ns = refined_ns;
  }
}

}  // namespace
}  // namespace odoless
