#include "rt/cpu_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

void compute_for(std::int64_t duration_ns) {
  const std::int64_t end_ns = thread_cpu_ns() + duration_ns;
  while (thread_cpu_ns() < end_ns) {
  }
}

TEST(CpuClock, OnlyEverAdvances) {
  for (auto* const clock : {&thread_cpu_ns, &process_cpu_ns, &monotonic_ns}) {
    std::int64_t last_ns = clock();
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t now_ns = clock();
      ASSERT_GE(now_ns, last_ns);
      last_ns = now_ns;
    }
  }
}

TEST(CpuClock, CountsWorkAndNotSleep) {
  const std::int64_t start_ns = thread_cpu_ns();
  const std::int64_t start_wall_ns = monotonic_ns();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GE(monotonic_ns() - start_wall_ns, 50 * kMs);
  EXPECT_LT(thread_cpu_ns() - start_ns, 25 * kMs);
  compute_for(5 * kMs);
  EXPECT_GE(thread_cpu_ns() - start_ns, 5 * kMs);
}

TEST(CpuClock, OfTheProcessCountsAllThreads) {
  const std::int64_t process_start_ns = process_cpu_ns();
  const std::int64_t thread_start_ns = thread_cpu_ns();
  std::thread([] { compute_for(20 * kMs); }).join();
  EXPECT_GE(process_cpu_ns() - process_start_ns, 20 * kMs);
  EXPECT_LT(thread_cpu_ns() - thread_start_ns, 10 * kMs);
}

TEST(CpuDeadline, ExpiresWhenItsBudgetIsComputed) {
  const CpuDeadline deadline(10 * kMs);
  EXPECT_FALSE(deadline.view().expired());
  compute_for(10 * kMs);
  EXPECT_TRUE(deadline.view().expired());
}

TEST(CpuDeadline, DoesNotExpireWhileItsThreadSleepsOrAnotherWorks) {
  const CpuDeadline deadline(20 * kMs);
  std::thread([] { compute_for(40 * kMs); }).join();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(deadline.view().expired());
}

TEST(CpuDeadline, OfNoBudgetHasExpired) { EXPECT_TRUE(CpuDeadline(0).view().expired()); }

TEST(Deadline, ByDefaultNeverExpires) { EXPECT_FALSE(Deadline().expired()); }

}  // namespace
}  // namespace odoless
