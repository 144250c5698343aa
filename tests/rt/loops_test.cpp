#include "rt/loops.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <thread>
#include <vector>

#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

/// The times at which steps ran that took the given time each.
std::vector<std::int64_t> due_times_ns(PeriodicLoop& loop, ManualClock& clock, const std::vector<int>& durations_ns) {
  std::vector<std::int64_t> due_ns;
  StopFlag stop;
  loop.run(stop, [&](std::int64_t now_due_ns) {
    clock.advance_by(durations_ns[due_ns.size()]);
    due_ns.push_back(now_due_ns);
    if (due_ns.size() == durations_ns.size()) {
      stop.request();
    }
  });
  return due_ns;
}

TEST(PeriodicLoop, StepsOnTheGrid) {
  ManualClock clock(1000);
  PeriodicLoop loop(clock, 100);
  EXPECT_EQ(due_times_ns(loop, clock, {10, 99, 0, 50}), (std::vector<std::int64_t>{1000, 1100, 1200, 1300}));
  EXPECT_EQ(loop.overruns(), 0U);
  EXPECT_EQ(loop.skipped(), 0U);
}

TEST(PeriodicLoop, SkipsTheTimesThatAnOverrunTook) {
  ManualClock clock(0);
  PeriodicLoop loop(clock, 100);
  EXPECT_EQ(due_times_ns(loop, clock, {10, 350, 10, 101, 0}), (std::vector<std::int64_t>{0, 100, 500, 600, 800}));
  EXPECT_EQ(loop.overruns(), 2U);
  EXPECT_EQ(loop.skipped(), 4U);
}

TEST(PeriodicLoop, StepThatEndsWhenTheNextIsDueIsInTime) {
  ManualClock clock(0);
  PeriodicLoop loop(clock, 100);
  EXPECT_EQ(due_times_ns(loop, clock, {100, 100, 200, 0}), (std::vector<std::int64_t>{0, 100, 200, 400}));
  EXPECT_EQ(loop.overruns(), 1U);
}

RC_GTEST_PROP(PeriodicLoop, EveryTimeHasAStepOrIsCounted, ()) {
  const auto durations_ns = *rc::gen::nonEmpty(rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 500)));
  ManualClock clock(0);
  PeriodicLoop loop(clock, 100);
  const auto due_ns = due_times_ns(loop, clock, durations_ns);
  std::int64_t end_of_last_ns = 0;
  std::uint64_t grid_times = 0;
  for (std::size_t i = 0; i < due_ns.size(); ++i) {
    RC_ASSERT(due_ns[i] % 100 == 0);
    RC_ASSERT(due_ns[i] >= end_of_last_ns);
    RC_ASSERT((i == 0 || due_ns[i] - std::max(end_of_last_ns, due_ns[i - 1] + 1) < 100));  // the first that can be
    end_of_last_ns = due_ns[i] + durations_ns[i];
    grid_times = static_cast<std::uint64_t>(due_ns[i] / 100) + 1;
  }
  const std::uint64_t counted = loop.skipped() + due_ns.size();
  RC_ASSERT(counted >= grid_times);  // those that the last step itself skipped are counted too
  RC_ASSERT(counted - grid_times <= 5U);
}

TEST(PeriodicLoop, KeepsRealTime) {
  MonotonicClock clock;
  PeriodicLoop loop(clock, 2'000'000);
  StopFlag stop;
  int steps = 0;
  const std::int64_t start_ns = monotonic_ns();
  loop.run(stop, [&](std::int64_t due_ns) {
    EXPECT_GE(clock.now_ns(), due_ns);
    if (++steps == 20) {
      stop.request();
    }
  });
  EXPECT_GE(monotonic_ns() - start_ns, 19 * 2'000'000);
}

TEST(EventLoop, StepsOncePerEventAndStops) {
  WakeUp wake_up;
  WakeUp answer;
  StopFlag stop;
  EventLoop loop(wake_up);
  int events = 0;
  std::thread runner([&] {
    loop.run(stop, [&](bool notified) {
      events += notified ? 1 : 0;
      answer.notify();
    });
  });
  for (int i = 0; i < 100; ++i) {
    wake_up.notify();
    ASSERT_TRUE(answer.wait(5'000'000'000));
  }
  stop.request();
  wake_up.notify();
  runner.join();
  EXPECT_EQ(events, 100);
}

TEST(EventLoop, StepsWithoutAnEventAfterItsTimeout) {
  WakeUp wake_up;
  StopFlag stop;
  EventLoop loop(wake_up, 1'000'000);
  int timeouts = 0;
  loop.run(stop, [&](bool notified) {
    EXPECT_FALSE(notified);
    if (++timeouts == 3) {
      stop.request();
    }
  });
  EXPECT_EQ(timeouts, 3);
}

}  // namespace
}  // namespace odoless
