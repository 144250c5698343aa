// A drive stops by itself when it hears nothing of the daemon for three periods; a bus has no room for more than that.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "drivers/tilt/cia402/canopen.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

/// When the daemon's heartbeats were sent.
std::vector<std::int64_t> heartbeats_ns(ServoBench& bench, int master_id, std::int64_t duration_ns) {
  constexpr std::uint32_t kHeartbeatCob = 0x700;
  std::vector<std::int64_t> sent_ns;
  bench.to_servo = [&, master_id](std::vector<ServoFrame>& frames) {
    for (const ServoFrame& bytes : frames) {
      CanFrame frame;
      std::memcpy(&frame, bytes.data(), bytes.size());
      if (frame.id == kHeartbeatCob + static_cast<std::uint32_t>(master_id)) {
        sent_ns.push_back(bench.now_ns());
      }
    }
  };
  bench.run(duration_ns);
  bench.to_servo = [](std::vector<ServoFrame>&) {};
  return sent_ns;
}

TEST(Cia402SignsOfLife, AreSentOncePerPeriodFromTheStartOnAndWhenTheLineWasOpenedAnew) {
  TiltParams params = test::servo_params(TiltDriver::kCia402);
  params.master_id = 100;
  ServoBench bench(params);
  for (int opened = 0; opened < 3; ++opened) {
    bench.reset();
    const std::int64_t reset_ns = bench.now_ns();
    const std::vector<std::int64_t> sent_ns = heartbeats_ns(bench, params.master_id, kServoSecond);
    ASSERT_GE(sent_ns.size(), 10U);
    EXPECT_LE(sent_ns.size(), 11U);
    EXPECT_LE(sent_ns.front() - reset_ns, 1 * kServoMs);
    for (std::size_t i = 1; i < sent_ns.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(sent_ns[i] - sent_ns[i - 1]), static_cast<double>(params.heartbeat_period_ns),
                  1.0 * kServoMs);
    }
    bench.run(730 * kServoMs);
  }
}

TEST(Cia402SignsOfLife, ComeNotInABundleAfterTheHostSlept) {
  const TiltParams params = test::servo_params(TiltDriver::kCia402);
  ServoBench bench(params);
  bench.reset();
  bench.run(kServoSecond);
  bench.host_asleep = true;
  bench.run(250 * kServoMs);
  bench.host_asleep = false;
  EXPECT_LE(heartbeats_ns(bench, params.master_id, 100 * kServoMs).size(), 4U);
}

TEST(Cia402SignsOfLife, AreNotSentByADaemonWithoutANumber) {
  TiltParams params = test::servo_params(TiltDriver::kCia402);
  params.master_id = 0;
  ServoBench bench(params);
  bench.reset();
  EXPECT_TRUE(heartbeats_ns(bench, 0, kServoSecond).empty());
  EXPECT_EQ(bench.session().state(), TiltState::kLevel);
}

}  // namespace
}  // namespace odoless
