#include "rt/heap_guard.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

namespace odoless {
namespace {

class HeapGuardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!heap_is_watched()) {
      ASSERT_FALSE(ODOLESS_HEAP_CAN_BE_WATCHED);
      GTEST_SKIP() << "the sanitizer owns the heap functions";
    }
    ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  }
};

void grow_a_vector() {
  const HeapGuard guard;
  std::vector<int> grown;
  grown.push_back(1);
}

void free_what_was_made_before() {
  void* volatile block = std::malloc(100);
  const HeapGuard guard;
  std::free(block);
}

void allocate_on_a_held_thread() {
  std::thread([] {
    forbid_heap_on_this_thread();
    void* volatile block = std::calloc(7, 11);
    std::free(block);
  }).join();
}

using HeapGuardDeathTest = HeapGuardTest;

TEST_F(HeapGuardDeathTest, AbortsOnGrowth) { EXPECT_DEATH(grow_a_vector(), "malloc of 4 bytes on thread ''"); }

TEST_F(HeapGuardDeathTest, AbortsOnFree) { EXPECT_DEATH(free_what_was_made_before(), "free of 0 bytes"); }

TEST_F(HeapGuardDeathTest, AbortsOnAThreadThatIsHeldForGood) {
  EXPECT_DEATH(allocate_on_a_held_thread(), "calloc of 77 bytes");
}

TEST_F(HeapGuardTest, EndsWithItsScope) {
  {
    const HeapGuard outer;
    { const HeapGuard inner; }
  }
  const std::int64_t calls_before = heap_calls_on_this_thread();
  const auto allowed = std::make_unique<int>(5);
  EXPECT_EQ(heap_calls_on_this_thread() - calls_before, 1);
}

TEST_F(HeapGuardTest, OuterGuardHoldsAfterAnInnerOne) {
  EXPECT_DEATH(
      {
        const HeapGuard outer;
        { const HeapGuard inner; }
        void* volatile block = std::malloc(5);
        std::free(block);
      },
      "malloc of 5 bytes");
}

TEST_F(HeapGuardTest, LeavesOtherThreadsAlone) {
  std::vector<std::thread> other(1);
  std::unique_ptr<int> made;
  {
    other[0] = std::thread([&made] { made = std::make_unique<int>(6); });
    const HeapGuard guard;
    other[0].join();
  }
  EXPECT_EQ(*made, 6);
}

}  // namespace
}  // namespace odoless
