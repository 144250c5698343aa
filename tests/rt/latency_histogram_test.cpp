#include "rt/latency_histogram.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

namespace odoless {
namespace {

static_assert(std::is_trivially_copyable_v<LatencyHistogram>);

constexpr double kRelativeError = 1.0 / 32;

/// Nearest rank, by sorting.
std::int64_t sorted_percentile(std::vector<std::int64_t> latencies_ns, double percent) {
  std::ranges::sort(latencies_ns);
  const double rank = std::ceil(percent / 100.0 * static_cast<double>(latencies_ns.size()));
  return latencies_ns[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

rc::Gen<std::int64_t> any_latency_ns() {
  return rc::gen::map(rc::gen::inRange(0, 80'001), [](int step) {  // evenly over the eight decades
    return static_cast<std::int64_t>(std::llround(std::pow(10.0, 3.0 + step * 1e-4)));
  });
}

RC_GTEST_PROP(LatencyHistogram, EveryDurationIsInTheBucketThatEndsAfterIt, ()) {
  const std::int64_t latency_ns = *any_latency_ns();
  LatencyHistogram histogram;
  histogram.record(latency_ns);
  RC_ASSERT(histogram.mean() == latency_ns);
  std::size_t bucket = 0;
  while (histogram.count_in(bucket) == 0) {
    ++bucket;
  }
  RC_ASSERT(latency_ns < LatencyHistogram::end_ns(bucket));
  RC_ASSERT(bucket == 0 || latency_ns >= LatencyHistogram::end_ns(bucket - 1));
}

RC_GTEST_PROP(LatencyHistogram, PercentilesAreThoseOfSortingWithinTheStatedError, ()) {
  const auto latencies_ns = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::int64_t>>(any_latency_ns()));
  LatencyHistogram histogram;
  for (const std::int64_t latency_ns : latencies_ns) {
    histogram.record(latency_ns);
  }
  for (const double percent : {0.0, 1.0, 25.0, 50.0, 90.0, 99.0, 99.9, 100.0}) {
    const auto exact_ns = static_cast<double>(sorted_percentile(latencies_ns, percent));
    RC_ASSERT(std::abs(static_cast<double>(histogram.percentile(percent)) - exact_ns) <= exact_ns * kRelativeError);
  }
  RC_ASSERT(histogram.max() == *std::ranges::max_element(latencies_ns));
  RC_ASSERT(histogram.count() == latencies_ns.size());
}

TEST(LatencyHistogram, IsRightWithinTheStatedErrorAtEveryBucketEdge) {
  for (std::int64_t edge_ns = 1024; edge_ns < 100'000'000'000; edge_ns += edge_ns / 64) {
    for (const std::int64_t latency_ns : {edge_ns - 1, edge_ns, edge_ns + 1}) {
      LatencyHistogram histogram;
      histogram.record(latency_ns);
      histogram.record(200'000'000'000);  // or the maximum would bound the answer
      const auto exact_ns = static_cast<double>(latency_ns);
      ASSERT_NEAR(static_cast<double>(histogram.percentile(50)), exact_ns, exact_ns * kRelativeError);
    }
  }
}

TEST(LatencyHistogram, OfNothingIsZero) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile(50), 0);
  EXPECT_EQ(histogram.max(), 0);
  EXPECT_EQ(histogram.count(), 0U);
}

TEST(LatencyHistogram, TakesWhatIsOutsideItsRange) {
  LatencyHistogram histogram;
  for (const std::int64_t latency_ns : {INT64_MIN, std::int64_t{-1}, std::int64_t{0}, std::int64_t{999}, INT64_MAX}) {
    histogram.record(latency_ns);
  }
  EXPECT_EQ(histogram.count(), 5U);
  EXPECT_EQ(histogram.max(), INT64_MAX);
  EXPECT_NEAR(static_cast<double>(histogram.percentile(50)), 1000.0, 1000.0 * kRelativeError);
  EXPECT_GE(histogram.percentile(100), 100'000'000'000);
}

}  // namespace
}  // namespace odoless
