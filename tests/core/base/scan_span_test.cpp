#include "core/base/scan_span.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

TEST(ScanSpan, IsTheTimeSinceTheLastScan) {
  ScanSpan span;
  EXPECT_LT(span.next_s(5'000'000'000), 0.01) << "the first stands for next to nothing";
  EXPECT_DOUBLE_EQ(span.next_s(5'100'000'000), 0.1);
  EXPECT_DOUBLE_EQ(span.next_s(5'125'000'000), 0.025);
}

TEST(ScanSpan, StampsThatAreTheSameRunBackwardsOrLeapStayWithinBounds) {
  ScanSpan span;
  static_cast<void>(span.next_s(5'000'000'000));
  for (const std::int64_t stamp_ns : {5'000'000'000, 3'000'000'000, 900'000'000'000}) {
    const double span_s = span.next_s(stamp_ns);
    EXPECT_GT(span_s, 0.0);
    EXPECT_LE(span_s, 0.25);
  }
}

}  // namespace
}  // namespace odoless
