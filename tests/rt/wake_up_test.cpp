#include "rt/wake_up.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <thread>

#include "rt/cpu_clock.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

bool is_readable(int descriptor) {
  pollfd watched{.fd = descriptor, .events = POLLIN, .revents = 0};
  return poll(&watched, 1, 0) == 1;
}

TEST(WakeUp, TimesOutWithoutANotification) {
  WakeUp wake_up;
  const std::int64_t start_ns = monotonic_ns();
  EXPECT_FALSE(wake_up.wait(20 * kMs));
  EXPECT_GE(monotonic_ns() - start_ns, 20 * kMs);
  EXPECT_FALSE(wake_up.wait(0));
}

TEST(WakeUp, KeepsANotificationForALaterSleeper) {
  WakeUp wake_up;
  wake_up.notify();
  EXPECT_TRUE(wake_up.wait(-1));
  EXPECT_FALSE(wake_up.wait(0));
}

TEST(WakeUp, TakesManyNotificationsForOne) {
  WakeUp wake_up;
  for (int i = 0; i < 1000; ++i) {
    wake_up.notify();
  }
  EXPECT_TRUE(wake_up.wait(0));
  EXPECT_FALSE(wake_up.wait(0));
}

TEST(WakeUp, IsReadableWhileNotified) {
  WakeUp wake_up;
  EXPECT_FALSE(is_readable(wake_up.descriptor()));
  wake_up.notify();
  EXPECT_TRUE(is_readable(wake_up.descriptor()));
  EXPECT_TRUE(wake_up.wait(0));
  EXPECT_FALSE(is_readable(wake_up.descriptor()));
}

TEST(WakeUp, LosesNoNotificationBetweenThreads) {
  constexpr int kRounds = 2000;
  WakeUp to_other;
  WakeUp back;
  std::atomic<int> answered = 0;
  std::thread other([&] {
    for (int i = 0; i < kRounds && to_other.wait(5'000 * kMs); ++i) {
      ++answered;
      back.notify();
    }
  });
  for (int i = 0; i < kRounds; ++i) {
    to_other.notify();
    if (!back.wait(5'000 * kMs)) {
      break;
    }
  }
  other.join();
  EXPECT_EQ(answered, kRounds);
}

}  // namespace
}  // namespace odoless
