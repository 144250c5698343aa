#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/lcm_receiver.hpp"
#include "firmware/lcm/messages.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/private_network.hpp"

namespace odoless {
namespace {

using test::KeepingTap;
using ::testing::ElementsAre;

constexpr std::size_t kMapCellsMax = 600UL * 600UL;

class LcmLinkAgain : public ::testing::TestWithParam<const char*> {};

// In turns as on an idle machine, or in a burst as where the publisher was kept waiting.
TEST_P(LcmLinkAgain, SendsEachScanAndMotionFiveTimesBeforeTheNextOfItsKind) {
  ODOLESS_NEEDS_NETWORK();
  LcmParams params;
  params.url = test::lcm_url();
  const Channels c;
  LcmReceiver receiver(params, {c.scan, c.scan_again, c.motion, c.motion_again});
  ASSERT_EQ(receiver.open(), Errc::kOk) << receiver.reason();
  LcmLink link(params, kMapCellsMax);
  KeepingTap tap;
  link.set_tap(&tap);
  link.send_again();
  ASSERT_EQ(link.open(), Errc::kOk) << link.reason();
  const std::vector<float> ranges_m = test::example_ranges_m(181);
  std::int64_t stamp_ns = 0;
  for (const char kind : std::string_view(GetParam())) {
    stamp_ns += 1'000'000;
    if (kind == 's') {
      ScanRecord scan = test::example_scan(181);
      scan.stamp_ns = stamp_ns;
      EXPECT_EQ(link.publish(scan, ranges_m), Errc::kOk);
    } else {
      Motion motion = test::example_motion();
      motion.to_stamp_ns = stamp_ns;
      EXPECT_EQ(link.publish(motion), Errc::kOk);
    }
  }
  std::map<std::string, std::vector<std::byte>> last;
  std::map<std::string, int> times;
  std::map<std::string, std::vector<int>> all_times;
  for (int heard = 0; const auto message = receiver.receive(heard < 24 ? 1'000'000'000 : 0); ++heard) {
    const std::string channel(message->channel);
    const std::vector<std::byte> payload(message->payload.begin(), message->payload.end());
    const std::string& kind = channel == c.scan_again ? c.scan : channel == c.motion_again ? c.motion : channel;
    if (kind != channel) {
      EXPECT_EQ(payload, last[kind]) << heard;
      ++times[kind];
    } else {
      all_times[kind].push_back(std::exchange(times[kind], 1));
    }
    last[kind] = payload;
  }
  EXPECT_THAT(all_times[c.scan], ElementsAre(0, 5, 5));
  EXPECT_THAT(all_times[c.motion], ElementsAre(0, 5, 5));
  EXPECT_EQ(tap.kept.size(), 6U) << "the record has each once";
}

TEST(LcmLinkScanTimes, GoBeforeEachScanWhoseLaserTellsThem) {
  LcmParams params;
  params.url = "";
  LcmLink link(params, kMapCellsMax);
  KeepingTap tap;
  link.set_tap(&tap);
  ScanRecord scan = test::example_scan(181);
  ASSERT_EQ(link.publish(scan, test::example_ranges_m(181)), Errc::kOk);
  scan.beam_period_ns = 25'000;
  ASSERT_EQ(link.publish(scan, test::example_ranges_m(181)), Errc::kOk);
  ASSERT_EQ(tap.kept.size(), 3U);
  EXPECT_EQ(tap.kept[0].channel, "ODOLESS_SCAN");
  EXPECT_EQ(tap.kept[1].channel, "ODOLESS_SCAN_TIMES");
  EXPECT_EQ(tap.kept[2].channel, "ODOLESS_SCAN");
  EXPECT_EQ(tap.last<scan_times_t>("ODOLESS_SCAN_TIMES").beam_period_ns, 25'000);
}

INSTANTIATE_TEST_SUITE_P(Orders, LcmLinkAgain, ::testing::Values("smsmsm", "sssmmm"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace odoless
