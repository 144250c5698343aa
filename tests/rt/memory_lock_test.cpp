#include "rt/memory_lock.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

constexpr std::size_t kBlock_bytes = 8 << 20;

/// Touches every page of a fresh block of the heap, and gives it back.
void use_heap() {
  void* volatile block = std::malloc(kBlock_bytes);
  std::memset(block, 1, kBlock_bytes);
  std::free(block);
}

int faults_of_heap_use_after_lock() {
  if (const int error = lock_memory(); error != 0) {
    return error == EPERM || error == ENOMEM ? -1 : -2;
  }
  use_heap();
  const ThreadFaults before = thread_page_faults();
  use_heap();
  return static_cast<int>(thread_page_faults().minor - before.minor);
}

class MemoryLockDeathTest : public ::testing::Test {  // each in a process of its own, as a lock stays
 protected:
  void SetUp() override {
    if (!AllocationGuard::kWorks) {
      GTEST_SKIP() << "a sanitizer's shadow is too large to lock";
    }
    ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  }
};

TEST_F(MemoryLockDeathTest, FreedMemoryStaysAndNeverFaultsAgain) {
  EXPECT_EXIT(
      {
        const int faults = faults_of_heap_use_after_lock();
        _exit(faults == -1 || (faults >= 0 && faults < 5) ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST_F(MemoryLockDeathTest, LockedBytesGrowWithTheHeap) {
  EXPECT_EXIT(
      {
        if (locked_bytes() != 0) {
          _exit(1);
        }
        if (lock_memory() != 0) {
          _exit(0);  // not allowed here
        }
        const std::size_t before_bytes = locked_bytes();
        use_heap();
        _exit(before_bytes > 0 && locked_bytes() >= before_bytes + kBlock_bytes ? 0 : 2);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(ThreadFaults, CountTouchedPages) {
  constexpr std::size_t kPages = 100;
  const auto page_bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  auto* const memory = static_cast<volatile char*>(
      mmap(nullptr, kPages * page_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(memory, MAP_FAILED);
  const ThreadFaults before = thread_page_faults();
  for (std::size_t i = 0; i < kPages; ++i) {
    memory[i * page_bytes] = 1;
  }
  EXPECT_GE(thread_page_faults().minor - before.minor, static_cast<std::int64_t>(kPages));
  munmap(const_cast<char*>(memory), kPages * page_bytes);
}

}  // namespace
}  // namespace odoless
