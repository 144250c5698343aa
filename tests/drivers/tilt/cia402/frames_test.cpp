// What a CANopen drive's frames are taken for: of which SYNC, of whom, and whether they can be.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/rng.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::data_frame;
using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

/// The drive runs, and a SYNC has just been on the bus. @return  When.
std::int64_t run_to_a_sync(ServoBench& bench) {
  bench.reset();
  bench.run(kServoSecond);
  const std::int64_t sync_ns = bench.now_ns() + 2 * kServoMs;
  bench.session().receive(as_bytes(canopen::sync()), sync_ns, bench.heard());
  return sync_ns;
}

TEST(Cia402Frames, AStampIsThatOfTheSyncOnTheBus) {
  ServoBench bench(test::servo_params(TiltDriver::kCia402));
  const std::int64_t sync_ns = run_to_a_sync(bench);
  const std::size_t before = bench.heard().samples.size();
  const CanFrame status = data_frame(0x181, {0x37, 0x06, 0, 0, 0, 0, 1});
  bench.session().receive(as_bytes(status), sync_ns + kServoMs, bench.heard());
  ASSERT_EQ(bench.heard().samples.size(), before + 1);
  EXPECT_EQ(bench.heard().samples.back().stamp_ns, sync_ns);
  EXPECT_EQ(bench.heard().samples.back().arrival_ns, sync_ns + kServoMs);
  bench.session().receive(as_bytes(status), sync_ns + kServoMs + 1, bench.heard());
  EXPECT_EQ(bench.heard().samples.size(), before + 1) << "a frame twice is one angle";
  EXPECT_TRUE(bench.heard().has(TiltEventType::kRejected, Errc::kImplausibleStamp));
  bench.session().receive(as_bytes(data_frame(0x81, {0x10, 0x23, 1})), sync_ns + 2 * kServoMs, bench.heard());
  EXPECT_TRUE(bench.heard().has(TiltEventType::kRejected, Errc::kFrameMalformed)) << "half an emergency";
}

TEST(Cia402Frames, AnAngleThatTheAxisCannotHaveComeToIsRefusedAndTold) {
  ServoBench bench(test::servo_params(TiltDriver::kCia402));
  const std::int64_t sync_ns = run_to_a_sync(bench);
  const std::size_t before = bench.heard().samples.size();
  const CanFrame far = data_frame(0x181, {0x37, 0x06, 0, 0, 1, 0, 1});  // 65536 counts
  bench.session().receive(as_bytes(far), sync_ns + kServoMs, bench.heard());
  EXPECT_EQ(bench.heard().samples.size(), before);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kRejected, Errc::kImplausibleAngle));
}

TEST(Cia402Frames, HeedsNoFramesOfOthers) {
  ServoBench bench(test::servo_params(TiltDriver::kCia402));
  bench.reset();
  bench.run(kServoSecond);
  const TiltCounters before = bench.session().counters();
  Rng rng(8);
  for (int i = 0; i < 10'000; ++i) {
    CanFrame frame = data_frame(rng.below(0x800), {0, 1, 2, 3, 4, 5, 6, 7});
    if ((frame.id & 0x7FU) == 1 || frame.id == 0x80) {
      frame.id = 0;
    }
    frame.id |= rng.below(4) == 0 ? CanFrame::kRemoteFlag : 0U;
    bench.session().receive(as_bytes(frame), bench.now_ns(), bench.heard());
  }
  EXPECT_EQ(bench.session().counters().rejected, before.rejected);
  EXPECT_EQ(bench.session().state(), TiltState::kLevel);
}

// Frames dropped, doubled, put out of order or changed in any byte: at most that frame's angle is lost, and none is
// passed on that cannot be.
TEST(Cia402Frames, DamagedFramesCostAtMostTheirOwnAngle) {
  Rng rng(12);
  for (int round = 0; round < 400; ++round) {
    ServoBench bench(test::servo_params(TiltDriver::kCia402));
    bench.reset();
    bench.run(1500 * kServoMs);
    ASSERT_EQ(bench.session().state(), TiltState::kLevel);
    const std::size_t before = bench.heard().samples.size();
    int left = 1;
    bench.to_session = [&](std::vector<ServoFrame>& frames) {
      if (frames.empty() || left-- <= 0) {
        return;
      }
      const std::size_t which = rng.below(static_cast<std::uint32_t>(frames.size()));
      switch (round % 4) {
        case 0:
          frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(which));
          return;
        case 1:
          frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(which), frames[which]);
          return;
        case 2:
          std::reverse(frames.begin(), frames.end());
          return;
        default:  // position and velocity: a status word that is changed so that it is another one counts as that
          const std::size_t at = 8 + 2 + rng.below(4);
          frames[which][at] ^= static_cast<std::byte>(1 + rng.below(255));
      }
    };
    bench.run(400 * kServoMs);
    EXPECT_GE(bench.heard().samples.size() + 1, before + 40);
    EXPECT_EQ(bench.session().state(), TiltState::kLevel) << round;
    for (const TiltSample& sample : bench.heard().samples) {
      ASSERT_NEAR(sample.angle_rad, bench.true_angle_rad(sample.stamp_ns), 0.06) << round;
    }
  }
}

}  // namespace
}  // namespace odoless
