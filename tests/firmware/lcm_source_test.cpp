#include "firmware/sources/lcm_source.hpp"

#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <algorithm>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/messages.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/private_network.hpp"

namespace odoless {
namespace {

using Stamps = std::vector<std::int64_t>;

/// Keeps what every message is of.
class KeepingSink final : public ScanSink {
 public:
  void on_scan(const RawScan& scan) override {
    scans_us.push_back(scan.stamp_ns / 1000);
    beam_periods_ns.push_back(scan.beam_period_ns);
  }
  void on_motion(const Motion& motion) override { motions_us.push_back(motion.to_stamp_ns / 1000); }
  void on_raw(RawLine /*line*/, std::span<const std::byte> /*bytes*/, bool /*to_device*/) override {}
  void on_tilt(const TiltRecord& /*tilt*/) override {}
  void on_event(EventPriority /*priority*/, EventText /*text*/, std::int64_t /*number*/) override {}

  Stamps scans_us;
  std::vector<std::int64_t> beam_periods_ns;
  Stamps motions_us;
};

/// A source, and a sender whose messages may be sent on any channel.
class LcmSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ODOLESS_NEEDS_NETWORK();
    params_.url = test::lcm_url();
    source_ = std::make_unique<LcmSource>(params_, channels_, 1081);
    ASSERT_EQ(source_->open(), Errc::kOk) << source_->reason();
    link_.set_tap(&tap_);  // which encodes; the sender sends
    lcm_.reset(lcm_create((params_.url + "?ttl=0").c_str()));
    ASSERT_NE(lcm_, nullptr);
  }

  void send_scan(const std::string& channel, std::int64_t stamp_us) {
    ScanRecord scan = test::example_scan(100);
    scan.stamp_ns = stamp_us * 1000;
    EXPECT_EQ(link_.publish(scan, test::example_ranges_m(100)), Errc::kOk);
    send_last(channel);
  }
  void send_times(const std::string& channel, std::int64_t beam_period_ns) {
    ScanRecord scan = test::example_scan(100);
    scan.beam_period_ns = beam_period_ns;
    scan_times_t message;
    to_message(scan, message);
    ASSERT_EQ(lcm::LCM(lcm_.get()).publish(channel, &message), 0);
  }
  void send_motion(const std::string& channel, std::int64_t to_stamp_us) {
    Motion motion = test::example_motion();
    motion.from_stamp_ns = std::max<std::int64_t>(to_stamp_us - 10, 0) * 1000;  // the first: as that of its end
    motion.to_stamp_ns = to_stamp_us * 1000;
    EXPECT_EQ(link_.publish(motion), Errc::kOk);
    send_last(channel);
  }
  KeepingSink& heard() {
    source_->work(ManualClock(), sink_);
    return sink_;
  }

  SourceHealth counts() const {
    SourceHealth health;
    source_->add_counts(health);
    return health;
  }

  Channels channels_;

 private:
  struct LastMessage final : LcmTap {
    void record(std::string_view /*channel*/, std::span<const std::byte> message, std::int64_t /*stamp_ns*/) override {
      bytes.assign(message.begin(), message.end());
    }
    std::vector<std::byte> bytes;
  };
  struct Closer {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  static LcmParams unsent() {
    LcmParams params;
    params.url = "";
    return params;
  }
  void send_last(const std::string& channel) {
    ASSERT_EQ(lcm_publish(lcm_.get(), channel.c_str(), tap_.bytes.data(), static_cast<unsigned int>(tap_.bytes.size())),
              0);
  }

  LcmParams params_;
  LastMessage tap_;
  LcmLink link_{unsent(), 100};
  std::unique_ptr<lcm_t, Closer> lcm_;
  std::unique_ptr<LcmSource> source_;
  KeepingSink sink_;
};

TEST_F(LcmSourceTest, TakesWhatWasLostWhenItComesAgainAndNothingTwice) {
  send_scan(channels_.scan, 10);
  send_scan(channels_.scan_again, 10);
  send_motion(channels_.motion, 10);
  send_scan(channels_.scan_again, 10);
  send_motion(channels_.motion_again, 10);
  // scan 20 is lost
  send_scan(channels_.scan_again, 20);
  send_motion(channels_.motion_again, 10);
  // motion 20 is lost
  send_scan(channels_.scan_again, 20);
  // and so when it is sent again
  send_scan(channels_.scan, 30);
  send_scan(channels_.scan_again, 30);
  send_motion(channels_.motion_again, 20);
  send_motion(channels_.motion, 30);
  EXPECT_EQ(heard().scans_us, (Stamps{10, 20, 30}));
  EXPECT_EQ(heard().motions_us, (Stamps{10, 20, 30}));
}

TEST_F(LcmSourceTest, TakesTheVeryFirstWhenItComesAgainAlsoOfStampZero) {
  send_scan(channels_.scan_again, 0);
  send_motion(channels_.motion_again, 0);
  send_scan(channels_.scan_again, 0);
  send_motion(channels_.motion_again, 0);
  EXPECT_EQ(heard().scans_us, Stamps{0});
  EXPECT_EQ(heard().motions_us, Stamps{0});
}

TEST_F(LcmSourceTest, FollowsASenderWhoseStampsBeginAgain) {
  send_scan(channels_.scan, 1000);
  send_motion(channels_.motion, 1000);
  send_scan(channels_.scan, 10);
  send_motion(channels_.motion, 10);
  send_scan(channels_.scan_again, 10);
  send_scan(channels_.scan, 20);
  send_motion(channels_.motion_again, 10);
  // motion 20 is lost
  send_motion(channels_.motion_again, 20);
  EXPECT_EQ(heard().scans_us, (Stamps{1000, 10, 20}));
  EXPECT_EQ(heard().motions_us, (Stamps{1000, 10, 20}));
}

TEST_F(LcmSourceTest, TimesOfBeamsHoldForTheScansBehindThem) {
  send_scan(channels_.scan, 10);
  send_times(channels_.scan_times, 25'000);
  send_scan(channels_.scan, 20);
  send_times("OTHER_SCAN_TIMES", 7);
  send_scan(channels_.scan_again, 30);
  send_times(channels_.scan_times, 26'000);
  send_times(channels_.scan_times, std::numeric_limits<std::int64_t>::max());  // which is refused
  send_scan(channels_.scan, 40);
  EXPECT_EQ(heard().beam_periods_ns, (std::vector<std::int64_t>{0, 25'000, 25'000, 26'000}));
  EXPECT_EQ(counts().rejected, 1);
}

TEST_F(LcmSourceTest, RefusesWhatIsNoMeasurement) {
  send_scan(channels_.motion, 10);  // of another type
  send_motion(channels_.scan_again, 10);
  send_scan(channels_.scan, 10);
  EXPECT_EQ(heard().scans_us, Stamps{10});
  EXPECT_EQ(heard().motions_us, Stamps{});
  EXPECT_EQ(counts().rejected, 1);
  EXPECT_EQ(counts().motions_refused, 1);
  EXPECT_EQ(counts().datagrams_lost, 0);
}

}  // namespace
}  // namespace odoless
