#include "rt/event_ring.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

template <class... Numbers>
std::string line(fmt::format_string<EventNumber<Numbers>...> text, Numbers... numbers) {
  EventRing ring(1);
  Event event;
  EXPECT_TRUE(ring.push(0, EventPriority::kInfo, text, numbers...));
  EXPECT_TRUE(ring.try_pop(event));
  return format(event);
}

TEST(EventRing, FormatsNumbersOfEveryKind) {
  EXPECT_EQ(line("ready"), "ready");
  EXPECT_EQ(line("{} beams", std::uint16_t{1081}), "1081 beams");
  EXPECT_EQ(line("{} {} {} {}", 1, -2L, 3.5, 0.25F), "1 -2 3.5 0.25");
  EXPECT_EQ(line("late by {:.1f} ms of {:>5}", 12.345, 25), "late by 12.3 ms of    25");
  EXPECT_EQ(line("{{}} {}", true), "{} 1");
  EXPECT_EQ(line("{}", std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
}

TEST(EventRing, KeepsStampPriorityAndOrder) {
  EventRing ring(2);
  EXPECT_TRUE(ring.push(100, EventPriority::kError, "first"));
  EXPECT_TRUE(ring.push(200, EventPriority::kDebug, "second"));
  Event event;
  ASSERT_TRUE(ring.try_pop(event));
  EXPECT_EQ(event.stamp_ns, 100);
  EXPECT_EQ(event.priority, EventPriority::kError);
  ASSERT_TRUE(ring.try_pop(event));
  EXPECT_EQ(event.stamp_ns, 200);
  EXPECT_EQ(format(event), "second");
  EXPECT_FALSE(ring.try_pop(event));
}

TEST(EventRing, CountsLinesThatHadNoRoom) {
  EventRing ring(2);
  for (int i = 0; i < 5; ++i) {
    ring.push(i, EventPriority::kInfo, "{}", i);
  }
  EXPECT_EQ(ring.rejected(), 3U);
  EXPECT_EQ(ring.high_water(), 2U);
  EXPECT_EQ(ring.capacity(), 2U);
}

TEST(EventRing, PushLeavesTheHeapAlone) {
  EventRing ring(10);
  const AllocationGuard heap;
  for (int i = 0; i < 20; ++i) {
    ring.push(i, EventPriority::kWarning, "{} of {}", i, 1.5);
  }
  EXPECT_EQ(heap.calls(), 0);
}

}  // namespace
}  // namespace odoless
