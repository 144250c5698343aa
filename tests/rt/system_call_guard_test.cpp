#include "rt/system_call_guard.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "rt/cpu_clock.hpp"
#include "rt/wake_up.hpp"
#include "tests/support/sanitizers.hpp"

namespace odoless {
namespace {

// What WakeUp needs, and the end of the process.
constexpr std::array kAllowed{SYS_write, SYS_read, SYS_ppoll, SYS_exit_group};

/// Holds a thread to kAllowed, runs `act` on it, and ends the process with 0 from there.
void run_held(const std::function<void()>& act) {
  std::thread([&act] {
    const std::vector<int> allowed(kAllowed.begin(), kAllowed.end());
    if (const int error = restrict_system_calls(allowed); error != 0) {
      _exit(100 + error);
    }
    act();
    syscall(SYS_exit_group, 0);
  }).join();
}

class SystemCallGuardDeathTest : public ::testing::Test {
 protected:
  void SetUp() override { ::testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

TEST_F(SystemCallGuardDeathTest, LetsThroughWhatIsListedAndTheVdso) {
  if (test::kThreadSanitizer) {
    GTEST_SKIP() << "ThreadSanitizer makes system calls of its own between them";
  }
  WakeUp wake_up;
  EXPECT_EXIT(run_held([&] {
                wake_up.notify();
                if (!wake_up.wait(1000) || monotonic_ns() == 0) {
                  _exit(1);
                }
              }),
              ::testing::ExitedWithCode(0), "");
}

TEST_F(SystemCallGuardDeathTest, KillsTheProcessOnAnyOtherCall) {
  EXPECT_EXIT(run_held([] { getppid(); }), ::testing::KilledBySignal(SIGSYS), "");
}

TEST_F(SystemCallGuardDeathTest, KillsOnAContendedLock) {
  EXPECT_EXIT(
      {
        std::mutex contended;
        const std::scoped_lock lock(contended);
        run_held([&] { const std::scoped_lock second(contended); });
      },
      ::testing::KilledBySignal(SIGSYS), "");
}

TEST_F(SystemCallGuardDeathTest, DoesNotSeeAFreeLock) {
  std::mutex uncontended;
  EXPECT_EXIT(run_held([&] { const std::scoped_lock lock(uncontended); }), ::testing::ExitedWithCode(0), "");
}

TEST_F(SystemCallGuardDeathTest, LeavesOtherThreadsAlone) {
  EXPECT_EXIT(
      {
        std::atomic<bool> other_is_done = false;
        std::atomic<bool> is_held = false;
        std::thread other([&] {
          while (!is_held) {
            std::this_thread::yield();
          }
          getppid();
          other_is_done = true;
        });
        run_held([&] {
          is_held = true;
          while (!other_is_done) {  // without a system call
          }
        });
        other.join();
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(SystemCallGuard, RefusesAListThatNoFilterHolds) {
  const std::vector<int> too_many(5000, SYS_read);
  EXPECT_EQ(restrict_system_calls(too_many), E2BIG);
}

}  // namespace
}  // namespace odoless
