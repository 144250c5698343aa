#include "rt/arena.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <vector>

#include "rt/memory_lock.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/sanitizers.hpp"

namespace odoless {
namespace {

struct alignas(256) Wide {
  double values[5] = {1, 2, 3, 4, 5};
};

template <class T>
bool take(Arena& arena, std::size_t count, std::vector<std::span<std::byte>>& taken) {
  const std::size_t used_before_bytes = arena.used_bytes();
  const std::span<T> span = arena.allocate<T>(count);
  if (span.empty()) {
    RC_ASSERT(arena.used_bytes() == used_before_bytes);
    return false;
  }
  RC_ASSERT(span.size() == count);
  RC_ASSERT(reinterpret_cast<std::uintptr_t>(span.data()) % alignof(T) == 0);
  taken.push_back(std::as_writable_bytes(span));
  return true;
}

RC_GTEST_PROP(Arena, SpansAreAlignedApartAndWithinTheCapacity, ()) {
  Arena arena(20'000);
  std::vector<std::span<std::byte>> taken;
  for (int i = 0; i < 50; ++i) {
    const auto count = static_cast<std::size_t>(*rc::gen::inRange(1, 2000));
    switch (*rc::gen::inRange(0, 3)) {
      case 0:
        take<char>(arena, count, taken);
        break;
      case 1:
        take<double>(arena, count, taken);
        break;
      default:
        take<Wide>(arena, count, taken);
    }
  }
  RC_ASSERT(arena.used_bytes() <= arena.capacity_bytes());
  for (std::size_t i = 1; i < taken.size(); ++i) {
    RC_ASSERT(taken[i].data() >= taken[i - 1].data() + taken[i - 1].size());
  }
}

TEST(Arena, GivesAllOfItsCapacityAndThenNothing) {
  Arena arena(8192);
  ASSERT_EQ(arena.capacity_bytes(), 8192U);
  EXPECT_EQ(arena.allocate<std::uint64_t>(1024).size(), 1024U);
  EXPECT_EQ(arena.used_bytes(), 8192U);
  EXPECT_TRUE(arena.allocate<char>(1).empty());
}

TEST(Arena, RefusesCountsThatOverflow) {
  Arena arena(4096);
  EXPECT_TRUE(arena.allocate<double>(SIZE_MAX / 8 + 1).empty());
  EXPECT_TRUE(arena.allocate<double>(SIZE_MAX).empty());
}

TEST(Arena, OfTooMuchMemoryIsEmpty) {
  for (const std::size_t capacity_bytes : {SIZE_MAX, SIZE_MAX / 2, std::size_t{0}}) {
    Arena arena(capacity_bytes);
    EXPECT_EQ(arena.capacity_bytes(), 0U);
    EXPECT_TRUE(arena.allocate<char>(1).empty());
  }
}

TEST(Arena, ValuesAreAsTheirConstructorLeavesThem) {
  Arena arena(10'000);
  for (const Wide& wide : arena.allocate<Wide>(10)) {
    ASSERT_EQ(wide.values[4], 5.0);
  }
  for (const int number : arena.allocate<int>(100)) {
    ASSERT_EQ(number, 0);
  }
}

TEST(Arena, NeitherFaultsNorAllocatesWhenUsed) {
  Arena arena(1'000'000);
  const AllocationGuard heap;
  const std::int64_t faults_before = thread_page_faults().minor;
  const std::span<int> all = arena.allocate<int>(250'000);
  const std::int64_t faults = thread_page_faults().minor - faults_before;
  EXPECT_EQ(heap.calls(), 0);
  if (!test::kThreadSanitizer) {                            // whose shadow is larger than what it shadows
    EXPECT_LT(faults, AllocationGuard::kWorks ? 10 : 100);  // of 245 pages; a sanitizer's shadow faults
  }
  EXPECT_EQ(all.size(), 250'000U);
}

}  // namespace
}  // namespace odoless
