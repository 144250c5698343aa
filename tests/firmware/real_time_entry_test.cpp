#include "firmware/daemon/real_time_entry.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>

#include "rt/real_time_thread.hpp"
#include "rt/wake_up.hpp"
#include "tests/support/sanitizers.hpp"

namespace odoless {
namespace {

/// Runs a loop as an enforced thread and waits for its end.
void run_and_join(const std::function<void()>& loop) {
  RealTimeThread thread({.name = "enforced"});
  ASSERT_EQ(thread.start([&loop] { run_enforced(sensor_system_calls(), loop); }), 0);
  thread.join();
}

class RealTimeEntryDeathTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::testing::FLAGS_gtest_death_test_style = "threadsafe";
    if (test::kThreadSanitizer) {
      GTEST_SKIP() << "ThreadSanitizer makes system calls of its own between them";
    }
  }
};

TEST_F(RealTimeEntryDeathTest, EndsAThreadThatCanBeJoined) {
  EXPECT_EXIT(
      {
        WakeUp wake_up;
        run_and_join([&] { wake_up.notify(); });
        _exit(wake_up.wait(0) ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST_F(RealTimeEntryDeathTest, KillsAThreadThatWaitsForALock) {
  EXPECT_EXIT(
      {
        std::mutex contended;
        std::atomic<bool> is_held = false;
        std::thread holder([&] {
          const std::scoped_lock lock(contended);
          is_held = true;
          std::this_thread::sleep_for(std::chrono::seconds(2));
        });
        while (!is_held) {
          std::this_thread::yield();
        }
        run_and_join([&] { const std::scoped_lock second(contended); });
        holder.join();
        _exit(0);
      },
      ::testing::KilledBySignal(SIGSYS), "");
}

TEST_F(RealTimeEntryDeathTest, KillsAThreadThatWaitsForAnotherToGoOn) {
  EXPECT_EXIT(
      {
        std::atomic<bool> goes_on = false;
        std::thread go_on([&] {
          std::this_thread::sleep_for(std::chrono::seconds(2));
          goes_on = true;
          goes_on.notify_all();
        });
        run_and_join([&] { goes_on.wait(false); });
        go_on.join();
        _exit(0);
      },
      ::testing::KilledBySignal(SIGSYS), "");
}

}  // namespace
}  // namespace odoless
