#include "firmware/threads/round.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

namespace odoless {
namespace {

void work_for(std::int64_t cpu_ns) {
  const std::int64_t end_ns = thread_cpu_ns() + cpu_ns;
  while (thread_cpu_ns() < end_ns) {
  }
}

TEST(StageTimer, KeepsWhenTheLongestRoundsWereAndCountsTheOnesOverTheBudget) {
  constexpr std::int64_t kBudget_ns = 20'000'000;
  StageTimer timer(kBudget_ns);
  StageReport report;
  const auto round = [&](std::int64_t cpu_ns) {
    timer.begin();
    work_for(cpu_ns);
    timer.end(report);
  };
  const auto few = [&] {
    for (std::size_t i = 0; i < report.longest.size(); ++i) {
      round(10'000);
    }
  };
  few();
  const std::int64_t before_ns = monotonic_ns();
  round(2 * kBudget_ns);
  const std::int64_t after_ns = monotonic_ns();
  few();
  EXPECT_EQ(report.scans, 1 + 2 * std::ssize(report.longest));
  EXPECT_GE(report.deadline_misses, 1);
  EXPECT_EQ(report.budget_ns, kBudget_ns);
  const auto late = std::ranges::find_if(
      report.longest, [&](const RoundTime& kept) { return kept.begin_ns >= before_ns && kept.end_ns <= after_ns; });
  ASSERT_NE(late, report.longest.end());
  EXPECT_GE(late->cpu_ns, 2 * kBudget_ns);
  EXPECT_GE(late->end_ns - late->begin_ns, late->cpu_ns);
  EXPECT_TRUE(std::ranges::all_of(report.longest, [](const RoundTime& kept) { return kept.cpu_ns >= 10'000; }));
}

}  // namespace
}  // namespace odoless
