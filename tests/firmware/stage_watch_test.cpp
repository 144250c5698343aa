#include "firmware/daemon/stage_watch.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "firmware/threads/round.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kHung_ns = 300'000'000;

/// A stage whose thread does one thing until the test ends.
class WatchedThread {
 public:
  WatchedThread(const std::function<void(std::atomic<std::uint64_t>&)>& round, int cpu = -1)
      : thread_({.name = "odo-watched", .cpu = cpu}) {
    EXPECT_EQ(thread_.start([this, round] {
      while (!over_) {
        round(heartbeat_);
      }
    }),
              0);
  }
  ~WatchedThread() {
    over_ = true;
    thread_.join();
  }
  WatchedThread(const WatchedThread&) = delete;
  WatchedThread& operator=(const WatchedThread&) = delete;

  /// How long the stage is silent in the eyes of somebody who looks so often, or until it counts as hung.
  std::int64_t silence_ns(int looks = 50) {
    StageWatch watch({{"watched", &thread_, &heartbeat_, &done_}});
    std::int64_t most_ns = 0;
    for (int i = 0; i < looks && most_ns < kHung_ns; ++i) {
      watch.look();
      most_ns = std::max(most_ns, watch.longest().lasts_ns);
      sleep_ns(StageWatch::kLook_ns);
    }
    return most_ns;
  }

  std::atomic<bool> done_ = false;

 private:
  std::atomic<bool> over_ = false;
  std::atomic<std::uint64_t> heartbeat_ = 0;
  RealTimeThread thread_;
};

TEST(StageWatch, HearsAStageThatAnswers) {
  WatchedThread stage([](auto& heartbeat) {
    ++heartbeat;
    sleep_ns(1'000'000);
  });
  EXPECT_LT(stage.silence_ns(), kHung_ns);
}

TEST(StageWatch, FindsAStageThatWaitsForEver) {
  WatchedThread stage([](auto&) { sleep_ns(10'000'000); });
  EXPECT_GE(stage.silence_ns(), kHung_ns);
}

TEST(StageWatch, FindsAStageThatLoopsForEver) {
  WatchedThread stage([](auto&) {});
  EXPECT_GE(stage.silence_ns(1000), kHung_ns) << "beside other tests it has a part of a processor";
}

TEST(StageWatch, LeavesAStageThatHasEnded) {
  WatchedThread stage([](auto&) { sleep_ns(10'000'000); });
  stage.done_ = true;
  EXPECT_EQ(stage.silence_ns(), 0);
}

// The processor that a busy thread of greater weight has for itself, almost: the other waits for it, and does not hang.
TEST(StageWatch, WaitsForAStageThatGetsNoProcessor) {
  const int cpu = sched_getcpu();
  const auto make_idle = [is_made = false](auto&) mutable {
    if (!is_made) {
      const sched_param none{};
      is_made = pthread_setschedparam(pthread_self(), SCHED_IDLE, &none) == 0;
    }
  };
  WatchedThread busy([](auto& heartbeat) { ++heartbeat; }, cpu);
  WatchedThread starved(make_idle, cpu);
  sleep_ns(100'000'000);
  EXPECT_LT(starved.silence_ns(), kHung_ns);
}

}  // namespace
}  // namespace odoless
