#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/lcm_receiver.hpp"
#include "firmware/sources/lcm_source.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kSecond;

/// Counts what comes.
class CountingSink final : public ScanSink {
 public:
  void on_scan(const RawScan& /*scan*/) override { ++scans; }
  void on_motion(const Motion& /*motion*/) override { ++motions; }
  void on_raw(RawLine /*line*/, std::span<const std::byte> /*bytes*/, bool /*to_device*/) override {}
  void on_tilt(const TiltRecord& /*tilt*/) override {}
  void on_event(EventPriority /*priority*/, EventText /*text*/, std::int64_t /*number*/) override {}

  int scans = 0;
  int motions = 0;
};

class LcmKeyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ODOLESS_NEEDS_NETWORK();
    url_ = test::lcm_url();
  }

  /// @param digit  Of the key; ' ': there is none.
  LcmParams params_of(char digit) const {
    LcmParams params;
    params.url = url_;
    if (digit != ' ') {
      const std::filesystem::path path = folder_.path() / std::string(1, digit);
      std::ofstream(path) << std::string(64, digit);
      std::filesystem::permissions(path, std::filesystem::perms::owner_read);
      params.key_file = path;
    }
    return params;
  }

  /// What a source with one key takes of a scan and a motion that were sent with another.
  SourceHealth exchange(char sent_with, char asked_for, CountingSink& sink) const {
    LcmSource source(params_of(asked_for), Channels(), 1081);
    EXPECT_EQ(source.open(), Errc::kOk) << source.reason();
    LcmLink link(params_of(sent_with), 100);
    EXPECT_EQ(link.open(), Errc::kOk) << link.reason();
    EXPECT_EQ(link.publish(test::example_scan(100), test::example_ranges_m(100)), Errc::kOk);
    EXPECT_EQ(link.publish(test::example_motion()), Errc::kOk);
    source.work(ManualClock(), sink);
    SourceHealth health;
    source.add_counts(health);
    return health;
  }

  test::TemporaryFolder folder_;
  std::string url_;
};

TEST_F(LcmKeyTest, WhoHasItIsHeard) {
  CountingSink sink;
  const SourceHealth health = exchange('a', 'a', sink);
  EXPECT_EQ(sink.scans, 1);
  EXPECT_EQ(sink.motions, 1);
  EXPECT_EQ(health.forged + health.replayed + health.rejected + health.motions_refused, 0);
}

TEST_F(LcmKeyTest, WhoHasAnotherOrNoneIsNotAndIsCounted) {
  for (const char other : {'b', ' '}) {
    CountingSink sink;
    const SourceHealth health = exchange(other, 'a', sink);
    EXPECT_EQ(sink.scans + sink.motions, 0) << other;
    EXPECT_EQ(health.forged, 2) << other;
  }
}

TEST_F(LcmKeyTest, AFileThatHoldsNoneIsSaidByBothEnds) {
  LcmParams params = params_of(' ');
  params.key_file = folder_.path() / "none";
  LcmSource source(params, Channels(), 1081);
  EXPECT_EQ(source.open(), Errc::kBadAddress);
  EXPECT_THAT(source.reason(), ::testing::HasSubstr("lcm.key_file"));
  LcmLink link(params, 100);
  EXPECT_EQ(link.open(), Errc::kBadAddress);
  EXPECT_THAT(link.reason(), ::testing::HasSubstr("lcm.key_file"));
}

// What programs that know of no key read: the message, and behind it, with a key, what they leave out.
TEST_F(LcmKeyTest, ChangesNothingOfAMessageAndIsForScansAndMotionsAlone) {
  const Channels channels;
  LcmReceiver receiver(params_of(' '), {channels.scan, channels.motion, channels.pose});
  ASSERT_EQ(receiver.open(), Errc::kOk) << receiver.reason();
  for (const char key : {' ', 'a'}) {
    LcmLink link(params_of(key), 100);
    test::KeepingTap tap;
    link.set_tap(&tap);
    ASSERT_EQ(link.open(), Errc::kOk) << link.reason();
    EXPECT_EQ(link.publish(test::example_scan(100), test::example_ranges_m(100)), Errc::kOk);
    EXPECT_EQ(link.publish(test::example_motion()), Errc::kOk);
    EXPECT_EQ(link.publish(test::example_pose()), Errc::kOk);
    for (int i = 0; i < 3; ++i) {
      const std::optional<LcmMessage> message = receiver.receive(kSecond);
      ASSERT_TRUE(message);
      const std::vector<std::byte>& said = tap.kept.at(static_cast<std::size_t>(i)).message;
      const std::size_t more_bytes = key != ' ' && message->channel != channels.pose ? kTrailerBytes : 0;
      ASSERT_EQ(message->payload.size(), said.size() + more_bytes) << message->channel;
      EXPECT_TRUE(std::equal(said.begin(), said.end(), message->payload.begin())) << message->channel;
    }
  }
}

}  // namespace
}  // namespace odoless
