#include "rt/latest_value.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

TEST(LatestValue, ShowsItsInitialValueUntilOneIsWritten) {
  LatestValue<std::string> latest("initial");
  EXPECT_FALSE(latest.update());
  EXPECT_EQ(latest.value(), "initial");
  latest.write("first");
  EXPECT_EQ(latest.value(), "initial");
  EXPECT_TRUE(latest.update());
  EXPECT_EQ(latest.value(), "first");
  EXPECT_FALSE(latest.update());
  EXPECT_EQ(latest.value(), "first");
}

TEST(LatestValue, DoesNotShowWhatIsNotPublished) {
  LatestValue<int> latest;
  latest.back() = 5;
  EXPECT_FALSE(latest.update());
  latest.publish();
  EXPECT_TRUE(latest.update());
  EXPECT_EQ(latest.value(), 5);
}

RC_GTEST_PROP(LatestValue, IsTheLastThatWasWritten, (const std::vector<bool>& is_write)) {
  LatestValue<int> latest(-1);
  int written = -1;
  int seen = -1;
  for (const bool write : is_write) {
    if (write) {
      latest.write(++written);
    } else {
      RC_ASSERT(latest.update() == (seen != written));
      seen = written;
    }
    RC_ASSERT(latest.value() == seen);
  }
}

TEST(LatestValue, LeavesTheHeapAlone) {
  LatestValue<int> latest;
  const AllocationGuard heap;
  latest.write(1);
  latest.update();
  EXPECT_EQ(heap.calls(), 0);
}

}  // namespace
}  // namespace odoless
