#include "firmware/lcm/lcm_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <chrono>
#include <cmath>
#include <set>

#include "core/base/rng.hpp"
#include "firmware/lcm/lcm_receiver.hpp"
#include "firmware/lcm/messages.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/private_network.hpp"

namespace odoless {
namespace {

using test::KeepingTap;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t kLinkMapCellsMax = 1'000'000;

// A link that sends nothing, and what it would have sent.
class LcmLinkTap : public ::testing::Test {
 protected:
  LcmLinkTap() { link_.set_tap(&tap_); }

  static LcmParams silent() {
    LcmParams params;
    params.url = "";
    return params;
  }
  KeepingTap tap_;
  LcmLink link_{silent(), kLinkMapCellsMax};
};

std::vector<std::uint8_t> inflated(const std::vector<std::uint8_t>& data, std::size_t size_bytes) {
  std::vector<std::uint8_t> out(size_bytes);
  uLongf out_bytes = size_bytes;
  EXPECT_EQ(uncompress(out.data(), &out_bytes, data.data(), data.size()), Z_OK);
  out.resize(out_bytes);
  return out;
}

TEST_F(LcmLinkTap, SendsAScanAsItIs) {
  const std::vector<float> ranges_m = test::example_ranges_m(1081);
  ASSERT_EQ(link_.publish(test::example_scan(1081), ranges_m), Errc::kOk);
  const auto scan = tap_.last<bot_core::planar_lidar_t>("ODOLESS_SCAN");
  EXPECT_EQ(scan.utime, 1'700'000'000'123'456);
  EXPECT_EQ(scan.ranges, ranges_m);
  EXPECT_EQ(scan.rad0, -2.3561945F);
  EXPECT_EQ(scan.radstep, 0.004363323F);
}

TEST_F(LcmLinkTap, IsToldWhenAMessageWasPublishedWhateverItsOwnStamp) {
  const auto now_ns = [] {
    return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  };
  const std::int64_t before_ns = now_ns();
  ASSERT_EQ(link_.publish(test::example_pose()), Errc::kOk);
  ASSERT_EQ(link_.publish(test::example_scan(3), test::example_ranges_m(3)), Errc::kOk);
  for (const auto& kept : tap_.kept) {
    EXPECT_GE(kept.stamp_ns, before_ns);
    EXPECT_LE(kept.stamp_ns, now_ns());
  }
}

TEST_F(LcmLinkTap, TellsReceivedBytesFromSentOnes) {
  const std::vector<std::byte> bytes{std::byte{0x00}, std::byte{0xff}, std::byte{'\n'}};
  ASSERT_EQ(link_.publish(RawBytesRecord{.stamp_ns = 5000, .size_bytes = 3, .to_device = 0}, bytes), Errc::kOk);
  ASSERT_EQ(link_.publish(RawBytesRecord{.stamp_ns = 6000, .size_bytes = 3, .to_device = 1}, bytes), Errc::kOk);
  EXPECT_EQ(tap_.last<bot_core::raw_t>("ODOLESS_LRF_RAW_RX").utime, 5);
  EXPECT_EQ(tap_.last<bot_core::raw_t>("ODOLESS_LRF_RAW_TX").utime, 6);
  EXPECT_THAT(tap_.last<bot_core::raw_t>("ODOLESS_LRF_RAW_TX").data, ::testing::ElementsAre(0, 255, '\n'));
}

TEST_F(LcmLinkTap, TellsTheBytesOfTheLinesApart) {
  const std::vector<std::byte> bytes{std::byte{1}};
  const auto channel_of = [&](RawLine line, std::int32_t to_device) {
    const RawBytesRecord raw{.stamp_ns = 7000, .size_bytes = 1, .to_device = to_device, .line = line};
    EXPECT_EQ(link_.publish(raw, bytes), Errc::kOk);
    return tap_.kept.back().channel;
  };
  EXPECT_EQ(channel_of(RawLine::kLaser, 0), "ODOLESS_LRF_RAW_RX");
  EXPECT_EQ(channel_of(RawLine::kLaser, 1), "ODOLESS_LRF_RAW_TX");
  EXPECT_EQ(channel_of(RawLine::kTilt, 0), "ODOLESS_TILT_RAW_RX");
  EXPECT_EQ(channel_of(RawLine::kTilt, 1), "ODOLESS_TILT_RAW_TX");
  EXPECT_EQ(channel_of(RawLine::kGpio, 0), "ODOLESS_GPIO_RAW_RX");
  EXPECT_EQ(channel_of(RawLine::kGpio, 1), "ODOLESS_GPIO_RAW_TX");
}

TEST_F(LcmLinkTap, SendsAPoseInEachForm) {
  ASSERT_EQ(link_.publish(test::example_pose()), Errc::kOk);
  const auto pose = tap_.last<bot_core::pose_t>("ODOLESS_POSE");
  EXPECT_EQ(pose.pos[0], 12.0);
  EXPECT_DOUBLE_EQ(2.0 * std::atan2(pose.orientation[3], pose.orientation[0]), 1.9);
  const auto estimate = tap_.last<pose_estimate_t>("ODOLESS_POSE_COVARIANCE");
  EXPECT_EQ(estimate.update_utime, 1'700'000'000'000'000);
  EXPECT_EQ(estimate.pose[2], 1.9);
  EXPECT_EQ(estimate.covariance[4], 2e-4);
  EXPECT_EQ(estimate.log_likelihood_per_beam, -1.25);
  EXPECT_EQ(estimate.effective_particles, 77.5);
  EXPECT_EQ(estimate.updated, 1);
  EXPECT_EQ(tap_.last<bot_core::pose_t>("ODOLESS_LASER_POSE").pos[0], 12.0);
  const auto map_T_odom = tap_.last<bot_core::rigid_transform_t>("ODOLESS_MAP_TO_ODOM");
  EXPECT_EQ(map_T_odom.trans[1], 0.25);
  EXPECT_DOUBLE_EQ(2.0 * std::atan2(map_T_odom.quat[3], map_T_odom.quat[0]), -0.1);
}

// The laser drives a quarter circle to the left: straight ahead in its own axes is along y of the map at the end.
TEST_F(LcmLinkTap, SaysTheVelocityInTheAxesOfTheMap) {
  Motion motion = test::example_motion();
  motion.previous_T_current = {0.05, 0.0, 0.0};
  PoseRecord pose = test::example_pose();
  pose.map_T_scan.yaw_rad = M_PI / 2.0;
  ASSERT_EQ(link_.publish(motion), Errc::kOk);
  ASSERT_EQ(link_.publish(pose), Errc::kOk);
  auto moving = tap_.last<bot_core::pose_t>("ODOLESS_POSE");
  EXPECT_NEAR(moving.vel[0], 0.0, 1e-12);
  EXPECT_NEAR(moving.vel[1], 2.0, 1e-12);  // 50 mm in 25 ms
  EXPECT_EQ(moving.rotation_rate[2], 0.0);

  motion.previous_T_current = {0.0, 0.0, 0.05};
  ASSERT_EQ(link_.publish(motion), Errc::kOk);
  ASSERT_EQ(link_.publish(pose), Errc::kOk);
  EXPECT_NEAR(tap_.last<bot_core::pose_t>("ODOLESS_POSE").rotation_rate[2], 2.0, 1e-12);

  pose.stamp_ns += 2'000'000'000;  // nobody knows how it moves now
  ASSERT_EQ(link_.publish(pose), Errc::kOk);
  EXPECT_EQ(tap_.last<bot_core::pose_t>("ODOLESS_POSE").rotation_rate[2], 0.0);
}

TEST_F(LcmLinkTap, PacksTilesAndNumbersThem) {
  Rng rng(1);
  std::vector<std::uint8_t> cells(128 * 128);
  for (std::uint8_t& cell : cells) {
    cell = rng.below(3) == 0 ? kUnknownCell : static_cast<std::uint8_t>(rng.below(101));
  }
  for (int sequence = 0; sequence < 3; ++sequence) {
    ASSERT_EQ(link_.publish(test::example_tile(128), cells), Errc::kOk);
    const auto tile = tap_.last<map_tile_t>("ODOLESS_MAP_TILE");
    EXPECT_EQ(tile.sequence, sequence);
    EXPECT_EQ(tile.column, -3);
    EXPECT_EQ(tile.row, 2);
    EXPECT_EQ(tile.size_cells, 128);
    EXPECT_EQ(tile.cell_size_m, 0.05);
    EXPECT_EQ(inflated(tile.data, cells.size() + 1), cells);
  }
}

TEST_F(LcmLinkTap, TellsWhyThePoseIsCorrectedAndHowFar) {
  const MapCorrection sent{5'000'000'000, CorrectionCause::kFound, 12, 87, 3, {0.5, -0.25, 0.125}};
  ASSERT_EQ(link_.publish(sent), Errc::kOk);
  const auto correction = tap_.last<correction_t>("ODOLESS_CORRECTION");
  EXPECT_EQ(correction.utime, 5'000'000);
  EXPECT_EQ(correction.cause, correction_t::FOUND);
  EXPECT_EQ(correction.older_submap, 12);
  EXPECT_EQ(correction.newer_submap, 87);
  EXPECT_EQ(correction.loop_closures, 3);
  EXPECT_THAT(correction.moved, ::testing::ElementsAre(0.5, -0.25, 0.125));
}

TEST_F(LcmLinkTap, ReportsHealthAndThatTheLaserLives) {
  ASSERT_EQ(link_.publish(test::example_health()), Errc::kOk);
  const auto health = tap_.last<health_t>("ODOLESS_HEALTH");
  EXPECT_EQ(health.state, health_t::DEGRADED);
  EXPECT_EQ(health.reasons, 8 + 65536);
  EXPECT_EQ(health.latched_reasons, 8 + 16 + 65536);
  EXPECT_EQ(health.lrf.accepted, 12345);
  EXPECT_EQ(health.pose_probability, 0.75);
  EXPECT_EQ(health.stages[2].p99_ms, 7.5);
  EXPECT_EQ(health.allocations, 0);
  EXPECT_EQ(health.checkpoint_age_s, -1.0);
  EXPECT_EQ(health.storage_error, 28);
  const auto cloud = tap_.last<cloud_health_t>("ODOLESS_CLOUD_HEALTH");
  EXPECT_EQ(cloud.points, 5000);
  EXPECT_EQ(cloud.used, 0.25);
  EXPECT_EQ(cloud.refused, 3);
  EXPECT_EQ(cloud.scans_left_out, 4);
  const auto world = tap_.last<world_t>("ODOLESS_WORLD");
  EXPECT_EQ(world.uuid, "8a1c");
  EXPECT_EQ(world.revision, 17);
  EXPECT_EQ(world.read_only, 1);
  EXPECT_EQ(world.place, world_t::GUESSED);
  EXPECT_EQ(tap_.last<bot_core::sensor_status_t>("ODOLESS_LRF_STATUS").rate, 40.0);
  for (const auto& [laser, type] : {std::pair<LrfDriver, int>(LrfDriver::kScip, 3),
                                    {LrfDriver::kSick, 2},
                                    {LrfDriver::kRplidar, -1},
                                    {LrfDriver::kLdrobot, -1},
                                    {LrfDriver::kYdlidar, -1},
                                    {LrfDriver::kSopas, 2},
                                    {LrfDriver::kCsv, -1},
                                    {LrfDriver::kLcm, -1}}) {
    link_.set_laser(laser);
    ASSERT_EQ(link_.publish(test::example_health()), Errc::kOk);
    EXPECT_EQ(tap_.last<bot_core::sensor_status_t>("ODOLESS_LRF_STATUS").type, type);
  }
}

TEST_F(LcmLinkTap, PutsPointsIntoTheMap) {
  const ScanRecord scan{.stamp_ns = 1000, .start_angle_rad = 0.0, .angle_step_rad = M_PI / 2.0, .beams = 3};
  const std::vector<float> ranges_m{2.0F, std::numeric_limits<float>::infinity(), 1.0F};
  PoseRecord pose = test::example_pose();
  pose.map_T_scan = {10.0, 20.0, M_PI / 2.0};
  ASSERT_EQ(link_.publish_points(pose, scan, ranges_m), Errc::kOk);
  const auto points = tap_.last<bot_core::pointcloud_t>("ODOLESS_SCAN_POINTS");
  ASSERT_EQ(points.n_points, 2);
  EXPECT_EQ(points.frame_id, "map");
  EXPECT_NEAR(points.points[0][0], 10.0, 1e-5);
  EXPECT_NEAR(points.points[0][1], 22.0, 1e-5);
  EXPECT_NEAR(points.points[1][1], 19.0, 1e-5);
}

TEST_F(LcmLinkTap, ThinsPointsThatWouldNotFit) {
  const std::vector<float> ranges_m(16384, 1.0F);
  ASSERT_EQ(link_.publish_points(test::example_pose(), test::example_scan(16384), ranges_m), Errc::kOk);
  const auto points = tap_.last<bot_core::pointcloud_t>("ODOLESS_SCAN_POINTS");
  EXPECT_GT(points.n_points, kPointsMax / 2);
  EXPECT_LE(tap_.kept.back().message.size(), kMessageMaxBytes);
}

TEST_F(LcmLinkTap, RefusesWhatOneDatagramCannotCarry) {
  const std::vector<float> ranges_m(15'000, 1.0F);
  EXPECT_EQ(link_.publish(test::example_scan(15'000), ranges_m), Errc::kTooLong);
  const std::vector<std::byte> bytes(60'001);
  EXPECT_EQ(link_.publish(RawBytesRecord{}, bytes), Errc::kTooLong);
  Rng rng(1);
  std::vector<std::uint8_t> noise(300 * 300);
  for (std::uint8_t& cell : noise) {
    cell = static_cast<std::uint8_t>(rng.below(256));
  }
  EXPECT_EQ(link_.publish(test::example_tile(300), noise), Errc::kTooLong);
  EXPECT_EQ(link_.counters().too_long, 3);
  EXPECT_TRUE(tap_.kept.empty());
}

TEST_F(LcmLinkTap, ShowsAWholeMapAsFineAsFits) {
  Rng rng(1);
  std::vector<std::uint8_t> noise(1000 * 1000);
  for (std::uint8_t& cell : noise) {
    cell = static_cast<std::uint8_t>(rng.below(101));
  }
  const MapView map{.stamp_ns = 7000,
                    .lower_left_x_m = -10.0,
                    .lower_left_y_m = 5.0,
                    .cell_size_m = 0.05,
                    .columns = 1000,
                    .rows = 1000,
                    .cells = noise};
  ASSERT_EQ(link_.publish(map), Errc::kOk);
  auto message = tap_.last<occ_map::pixel_map_t>("ODOLESS_MAP");
  EXPECT_EQ(message.dimensions[0], 250);  // of the noise, which is less after merging, 250 * 250 is what fits
  EXPECT_EQ(message.mpp, 0.2);
  EXPECT_EQ(message.xy1[0], 40.0);
  EXPECT_LE(tap_.kept.back().message.size(), kMessageMaxBytes);
  EXPECT_EQ(inflated(message.mapData, 62'501).size(), 62'500U);

  const std::vector<std::uint8_t> empty(1000 * 1000, kUnknownCell);
  MapView plain = map;
  plain.cells = empty;
  ASSERT_EQ(link_.publish(plain), Errc::kOk);
  message = tap_.last<occ_map::pixel_map_t>("ODOLESS_MAP");
  EXPECT_EQ(message.dimensions[0], 1000);
  EXPECT_EQ(message.xy0[1], 5.0);
}

TEST(LcmLink, SaysWhyItCannotOpen) {
  LcmParams params;
  params.url = "udpm://239.255.76.67:7667?ttl=3";
  LcmLink with_ttl(params, kLinkMapCellsMax);
  EXPECT_EQ(with_ttl.open(), Errc::kBadAddress);
  EXPECT_THAT(with_ttl.reason(), HasSubstr("set the parameter ttl"));

  params = {};
  params.prefix = std::string(41, 'x');
  LcmLink with_prefix(params, kLinkMapCellsMax);
  EXPECT_EQ(with_prefix.open(), Errc::kBadAddress);

  params = {};
  params.url = "nonsense://here";
  LcmLink with_nonsense(params, kLinkMapCellsMax);
  EXPECT_EQ(with_nonsense.open(), Errc::kUnavailable);
  EXPECT_THAT(with_nonsense.reason(), HasSubstr("'nonsense://here'"));
}

TEST(LcmLink, GoesOnWithoutANetworkAndStillRecords) {
  LcmLink link({}, kLinkMapCellsMax);
  KeepingTap tap;
  link.set_tap(&tap);
  EXPECT_EQ(link.publish(test::example_motion()), Errc::kUnavailable);
  EXPECT_EQ(link.counters().errors, 1);
  EXPECT_EQ(link.counters().messages, 0);
  EXPECT_EQ(tap.kept.size(), 1U);
}

// Everything that a daemon sends, once.
void publish_all(LcmLink& link, const std::vector<float>& ranges_m, const std::vector<std::uint8_t>& cells) {
  const ScanRecord scan = test::example_scan(static_cast<int>(ranges_m.size()));
  EXPECT_EQ(link.publish(scan, ranges_m), Errc::kOk);
  for (const RawLine line : {RawLine::kLaser, RawLine::kTilt, RawLine::kGpio}) {
    for (const std::int32_t to_device : {0, 1}) {
      const RawBytesRecord raw{.stamp_ns = 1000, .size_bytes = 4, .to_device = to_device, .line = line};
      EXPECT_EQ(link.publish(raw, std::as_bytes(std::span(cells).first(4))), Errc::kOk);
    }
  }
  EXPECT_EQ(link.publish(TiltRecord{.stamp_ns = 1000, .angle_rad = 0.25, .velocity_radps = -1.5}), Errc::kOk);
  EXPECT_EQ(link.publish(test::example_motion()), Errc::kOk);
  EXPECT_EQ(link.publish(test::example_pose()), Errc::kOk);
  EXPECT_EQ(link.publish_points(test::example_pose(), scan, ranges_m), Errc::kOk);
  EXPECT_EQ(link.publish(test::example_tile(100), std::span(cells).first(100 * 100)), Errc::kOk);
  EXPECT_EQ(link.publish(test::example_health()), Errc::kOk);
  EXPECT_EQ(link.publish(MapView{.cell_size_m = 0.1, .columns = 600, .rows = 600, .cells = cells}), Errc::kOk);
}

std::vector<std::uint8_t> noisy_cells(std::size_t count) {
  Rng rng(2);
  std::vector<std::uint8_t> cells(count);
  for (std::uint8_t& cell : cells) {
    cell = static_cast<std::uint8_t>(rng.below(101));
  }
  return cells;
}

TEST(LcmLink, SendsOneOfEachToWhoeverListens) {
  ODOLESS_NEEDS_NETWORK();
  LcmParams params;
  params.url = test::lcm_url();
  params.raw_bytes = true;
  const Channels c;
  const std::vector<std::string> all{c.tilt,        c.scan,        c.lrf_raw_rx,      c.lrf_raw_tx,   c.motion,
                                     c.pose,        c.laser_pose,  c.pose_covariance, c.map_to_odom,  c.map_tile,
                                     c.map,         c.health,      c.lrf_status,      c.scan_points,  c.tilt_raw_rx,
                                     c.tilt_raw_tx, c.gpio_raw_rx, c.gpio_raw_tx,     c.cloud_health, c.world};
  LcmReceiver receiver(params, all);
  ASSERT_EQ(receiver.open(), Errc::kOk) << receiver.reason();
  LcmLink link(params, kLinkMapCellsMax);
  KeepingTap tap;
  link.set_tap(&tap);
  ASSERT_EQ(link.open(), Errc::kOk) << link.reason();
  publish_all(link, test::example_ranges_m(1081), noisy_cells(600 * 600));

  std::set<std::string> heard;
  for (const KeepingTap::Kept& sent : tap.kept) {
    const auto message = receiver.receive(1'000'000'000);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->channel, sent.channel);
    EXPECT_TRUE(std::equal(message->payload.begin(), message->payload.end(), sent.message.begin(), sent.message.end()));
    EXPECT_LE(message->payload.size(), kMessageMaxBytes);
    heard.emplace(message->channel);
  }
  EXPECT_EQ(heard, std::set<std::string>(all.begin(), all.end()));
  EXPECT_EQ(link.counters().messages, receiver.counters().messages);
  EXPECT_EQ(link.counters().errors, 0);
  EXPECT_EQ(receiver.counters().lost, 0);
}

TEST(LcmLink, TellsTheTiltAsAJoint) {
  LcmParams params;
  params.url = "";
  LcmLink link(params, kLinkMapCellsMax);
  KeepingTap tap;
  link.set_tap(&tap);
  EXPECT_EQ(link.publish(TiltRecord{.stamp_ns = 5'000, .angle_rad = 0.25, .velocity_radps = -1.5}), Errc::kOk);
  ASSERT_EQ(tap.kept.size(), 1U);
  bot_core::joint_state_t message;
  ASSERT_GT(message.decode(tap.kept[0].message.data(), 0, static_cast<int>(tap.kept[0].message.size())), 0);
  EXPECT_EQ(tap.kept[0].channel, "ODOLESS_TILT");
  EXPECT_EQ(message.utime, 5);
  ASSERT_EQ(message.num_joints, 1);
  EXPECT_EQ(message.joint_name[0], "tilt");
  EXPECT_EQ(message.joint_position[0], 0.25F);
  EXPECT_EQ(message.joint_velocity[0], -1.5F);
}

TEST(LcmLink, AllocatesNothingOnceItRuns) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer has the heap";
  }
  ODOLESS_NEEDS_NETWORK();
  LcmParams params;
  params.url = test::lcm_url();
  params.raw_bytes = true;
  LcmLink link(params, kLinkMapCellsMax);
  link.send_again();
  ASSERT_EQ(link.open(), Errc::kOk) << link.reason();
  const std::vector<float> ranges_m = test::example_ranges_m(1081);
  const std::vector<std::uint8_t> cells = noisy_cells(600 * 600);
  publish_all(link, ranges_m, cells);
  const AllocationGuard guard;
  publish_all(link, ranges_m, cells);
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace odoless
