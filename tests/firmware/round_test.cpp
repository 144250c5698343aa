#include "firmware/threads/round.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

void work_for(std::int64_t cpu_ns) {
  const std::int64_t end_ns = thread_cpu_ns() + cpu_ns;
  while (thread_cpu_ns() < end_ns) {
  }
}

TEST(StageTimer, KeepsWhenTheLongestRoundWasAndCountsTheOnesOverTheBudget) {
  constexpr std::int64_t kBudget_ns = 20'000'000;
  StageTimer timer(kBudget_ns);
  StageReport report;
  const auto round = [&](std::int64_t cpu_ns) {
    timer.begin();
    work_for(cpu_ns);
    timer.end(report);
  };
  round(0);
  const std::int64_t before_ns = monotonic_ns();
  round(2 * kBudget_ns);
  const std::int64_t after_ns = monotonic_ns();
  round(0);
  EXPECT_EQ(report.scans, 3);
  EXPECT_GE(report.deadline_misses, 1);
  EXPECT_EQ(report.budget_ns, kBudget_ns);
  EXPECT_GE(report.longest.begin_ns, before_ns);
  EXPECT_LE(report.longest.end_ns, after_ns);
  EXPECT_GE(report.longest.end_ns - report.longest.begin_ns, 2 * kBudget_ns);
  EXPECT_GE(report.cpu.max(), 2 * kBudget_ns);
}

}  // namespace
}  // namespace odoless
