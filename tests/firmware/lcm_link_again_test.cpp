#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/lcm_receiver.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/private_network.hpp"

namespace odoless {
namespace {

using test::KeepingTap;
using ::testing::ElementsAre;

constexpr std::size_t kMapCellsMax = 600UL * 600UL;

TEST(LcmLink, SendsTheLastScanAndMotionAgainBeforeEachOfThem) {
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
  const std::vector<float> ranges_m = test::example_ranges_m(1081);
  for (std::int64_t i = 1; i <= 3; ++i) {
    ScanRecord scan = test::example_scan(1081);
    scan.stamp_ns = i * 1'000'000;
    EXPECT_EQ(link.publish(scan, ranges_m), Errc::kOk);
    MotionRecord motion = test::example_motion();
    motion.to_stamp_ns = i * 1'000'000;
    EXPECT_EQ(link.publish(motion), Errc::kOk);
  }
  std::map<std::string, std::vector<std::byte>> last;
  std::vector<std::string> order;
  while (const auto message = receiver.receive(order.size() < 15 ? 1'000'000'000 : 0)) {
    const std::string channel(message->channel);
    const std::vector<std::byte> payload(message->payload.begin(), message->payload.end());
    if (channel == c.scan_again || channel == c.motion_again) {
      EXPECT_EQ(payload, last[channel == c.scan_again ? c.scan : c.motion]) << order.size();
    }
    last[channel] = payload;
    order.push_back(channel);
  }
  EXPECT_THAT(order, ElementsAre(c.scan, c.scan_again, c.motion,          //
                                 c.scan_again, c.motion_again, c.scan,    //
                                 c.scan_again, c.motion_again, c.motion,  //
                                 c.scan_again, c.motion_again, c.scan,    //
                                 c.scan_again, c.motion_again, c.motion));
  EXPECT_EQ(tap.kept.size(), 6U) << "the record has each once";
}

}  // namespace
}  // namespace odoless
