#include "rt/real_time_thread.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "rt/memory_lock.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/sanitizers.hpp"

namespace odoless {
namespace {

std::string system_name() {
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  return name.data();
}

TEST(RealTimeThread, RunsItsBodyOnceUnderItsName) {
  RealTimeThread thread({.name = "a_name_that_is_too_long"});
  std::string own_name;
  std::string short_name;
  int runs = 0;
  ASSERT_FALSE(thread.started());
  ASSERT_EQ(thread.start([&] {
    own_name = real_time_thread_name();
    short_name = system_name();
    ++runs;
  }),
            0);
  EXPECT_TRUE(thread.started());
  thread.join();
  thread.join();
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(own_name, "a_name_that_is_too_long");
  EXPECT_EQ(short_name, "a_name_that_is_");
  EXPECT_STREQ(real_time_thread_name(), "");
}

TEST(RealTimeThread, RunsAtItsPriorityOrSaysWhyNot) {
  RealTimeThread thread({.name = "fifo", .priority = 7});
  int policy = -1;
  sched_param scheduling{};
  ASSERT_EQ(thread.start([&] { pthread_getschedparam(pthread_self(), &policy, &scheduling); }), 0);
  thread.join();
  if (thread.scheduling_error() == 0) {
    EXPECT_EQ(policy, SCHED_FIFO);
    EXPECT_EQ(scheduling.sched_priority, 7);
  } else {
    EXPECT_EQ(thread.scheduling_error(), EPERM);
    EXPECT_EQ(policy, SCHED_OTHER);
  }
}

TEST(RealTimeThread, RunsOnAllTheSameWhenThePriorityIsRefused) {
  RealTimeThread thread({.name = "impossible", .priority = 1000});
  bool ran = false;
  ASSERT_EQ(thread.start([&] { ran = true; }), 0);
  EXPECT_NE(thread.scheduling_error(), 0);
  thread.join();
  EXPECT_TRUE(ran);
}

TEST(RealTimeThread, RunsOnItsProcessor) {
  for (const int cpu : {0, 1 << 20, CPU_SETSIZE - 1}) {
    RealTimeThread thread({.name = "pinned", .cpu = cpu});
    int ran_on = -1;
    ASSERT_EQ(thread.start([&] { ran_on = sched_getcpu(); }), 0);
    thread.join();
    if (cpu == 0) {
      EXPECT_EQ(thread.affinity_error(), 0);
      EXPECT_EQ(ran_on, 0);
    } else {
      EXPECT_EQ(thread.affinity_error(), EINVAL);
    }
  }
}

/// Writes to `size_bytes` of the stack, and nothing else.
[[gnu::noinline]] void use_stack(std::size_t size_bytes) {
  auto* const memory = static_cast<volatile char*>(__builtin_alloca(size_bytes));
  for (std::size_t i = 0; i < size_bytes; i += 256) {
    memory[i] = 1;
  }
}

TEST(RealTimeThread, ItsStackIsThereBeforeItIsUsed) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer's own memory faults";
  }
  RealTimeThread thread({.name = "stack", .stack_bytes = 1 << 20});
  std::int64_t faults = -1;
  ASSERT_EQ(thread.start([&] {
    const std::int64_t faults_before = thread_page_faults().minor;
    use_stack(900 * 1024);
    faults = thread_page_faults().minor - faults_before;
  }),
            0);
  thread.join();
  EXPECT_GE(faults, 0);
  EXPECT_LT(faults, 5);  // of 225 pages
}

TEST(RealTimeThreadDeathTest, OverflowOfTheStackHitsTheGuardPage) {
  if (test::kThreadSanitizer) {
    GTEST_SKIP() << "ThreadSanitizer has a share of the stack, of a size that it doesn't tell";
  }
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      {
        RealTimeThread thread({.name = "overflow", .stack_bytes = 1 << 16});
        if (thread.start([] { use_stack(1 << 16); }) == 0) {
          thread.join();
        }
      },
      "");
}

TEST(RealTimeThread, SaysWhenThereIsNoMemoryForItsStack) {
  RealTimeThread thread({.name = "huge", .stack_bytes = std::size_t{1} << 60});
  EXPECT_EQ(thread.start([] {}), ENOMEM);
  EXPECT_FALSE(thread.started());
  thread.join();
}

TEST(RealTimeThread, IsJoinedWhenItGoes) {
  std::atomic<bool> ended = false;
  {
    RealTimeThread thread({.name = "joined"});
    ASSERT_EQ(thread.start([&] {
      use_stack(100);
      ended = true;
    }),
              0);
  }
  EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace odoless
