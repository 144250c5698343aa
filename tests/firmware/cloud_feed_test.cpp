#include "firmware/publisher/cloud_feed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/messages.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

using test::KeepingTap;

constexpr int kBeams = 361;
constexpr std::int64_t kPeriod_ns = 25'000'000;
constexpr double kTilt_radps = 1.0;

double tilt_rad(std::int64_t stamp_ns) { return 0.5 * std::sin(kTilt_radps * static_cast<double>(stamp_ns) * 1e-9); }

Pose2 odom_T_scan(std::int64_t stamp_ns) { return {0.5 * static_cast<double>(stamp_ns) * 1e-9, 0.0, 0.0}; }

/// A robot that drives straight at 0.5 m/s and is told of as the real-time stages would tell: each scan, an angle every
/// 10 ms, and a pose for every `level_every`-th scan.
class Robot {
 public:
  explicit Robot(CloudFeed& feed) : feed_(feed) {}

  void drive(int scans, int level_every = 1) {
    for (int i = 0; i < scans; ++i, ++scan_) {
      const std::int64_t stamp_ns = scan_ * kPeriod_ns;
      for (std::int64_t angle_ns = stamp_ns; angle_ns < stamp_ns + kPeriod_ns; angle_ns += 5'000'000) {
        feed_.add(TiltRecord{.stamp_ns = angle_ns, .angle_rad = tilt_rad(angle_ns)});
      }
      feed_.add(ScanRecord{.stamp_ns = stamp_ns,
                           .start_angle_rad = -std::numbers::pi / 2.0,
                           .angle_step_rad = std::numbers::pi / (kBeams - 1),
                           .beams = kBeams,
                           .beam_period_ns = 30'000},
                std::vector<float>(kBeams, 4.0F + 0.001F * static_cast<float>(scan_ % 7)));
      if (scan_ % level_every == 0) {
        tell_pose(stamp_ns);
      }
      feed_.work();
    }
  }

  /// From now on the map has the robot elsewhere.
  void leap(const Pose2& map_T_odom) { map_T_odom_ = map_T_odom; }
  void begin_map() { ++map_number_; }

  /// The trajectory, put elsewhere.
  [[nodiscard]] std::vector<StampedPose> path(const Pose2& map_T_odom) const {
    std::vector<StampedPose> out;
    for (const std::int64_t stamp_ns : updates_ns_) {
      out.push_back({stamp_ns, map_T_odom * odom_T_scan(stamp_ns)});
    }
    return out;
  }

 private:
  void tell_pose(std::int64_t stamp_ns) {
    if (updates_ns_.empty() || stamp_ns - updates_ns_.back() >= 400'000'000) {
      updates_ns_.push_back(stamp_ns);
    }
    Motion motion;
    motion.to_stamp_ns = stamp_ns;
    motion.odom_T_current = odom_T_scan(stamp_ns);
    feed_.add(motion);
    PoseRecord pose;
    pose.stamp_ns = stamp_ns;
    pose.map_T_odom = map_T_odom_;
    pose.map_T_scan = map_T_odom_ * odom_T_scan(stamp_ns);
    pose.map_number = map_number_;
    pose.update_stamp_ns = updates_ns_.back();
    pose.update_T_scan = odom_T_scan(updates_ns_.back()).inverse() * odom_T_scan(stamp_ns);
    feed_.add(pose);
  }

  CloudFeed& feed_;
  Pose2 map_T_odom_{};
  std::int32_t map_number_ = 0;
  std::int64_t scan_ = 0;
  std::vector<std::int64_t> updates_ns_;
};

MappingParams params() {
  MappingParams params;
  params.cloud.points_max = 300'000;
  params.cloud.key_voxels_max = 60'000;
  return params;
}

std::vector<Point3> points_in_map(const CloudFeed& feed) {
  std::vector<Point3> out;
  for_each_point(feed.cloud(), [&out](std::size_t, const Point3& p_map, std::uint32_t) { out.push_back(p_map); });
  return out;
}

/// Publishes until nothing is left, and puts together what a reader has then: per key the newest edition.
std::size_t read_all(CloudFeed& feed, std::map<int, std::pair<int, std::vector<CloudPoint>>>& reader) {
  std::size_t pieces = 0;
  for (CloudPiece piece = feed.next_piece(kCloudPointsMax); !piece.points.empty();
       piece = feed.next_piece(kCloudPointsMax), ++pieces) {
    auto& [edition, points] = reader[piece.key];
    if (piece.edition != edition) {
      points.clear();
    }
    edition = piece.edition;
    points.insert(points.end(), piece.points.begin(), piece.points.end());
  }
  return pieces;
}

TEST(CloudFeed, WaitsForPosesAndAnglesAndPutsPointsWhereTheyBelong) {
  CloudFeed feed(params(), kBeams);
  Robot robot(feed);
  robot.drive(240, 20);  // a level scan every half second
  EXPECT_GT(feed.cloud().keys().size(), 1U);
  EXPECT_EQ(feed.health().scans_left_out, 0);
  // Every point is 4 m from where the laser was, 0.6 m high, at some time.
  for (const Point3& p : points_in_map(feed)) {
    const double x_m = std::clamp(p.x_m, 0.0, 3.0);
    EXPECT_LE(std::hypot(p.x_m - x_m, p.y_m, p.z_m - 0.6), 4.1);
    EXPECT_LE(std::abs(p.z_m - 0.6), 4.1 * std::sin(0.5));
  }
}

TEST(CloudFeed, LeavesOutScansWithoutPosesAndGoesOn) {
  CloudFeed feed(params(), kBeams);
  Robot robot(feed);
  robot.drive(10);
  const std::size_t before = feed.cloud().size();
  robot.drive(200, 1'000);  // 5 s without a level scan: longer than pose_gap_max_s, and than scans may wait
  EXPECT_EQ(feed.cloud().size(), before);
  robot.drive(40);
  EXPECT_GT(feed.health().scans_left_out, 150);
  EXPECT_GT(feed.cloud().size(), before);
}

TEST(CloudFeed, PublishesEveryPointInPiecesAndAnewWhatIsCorrected) {
  CloudFeed feed(params(), kBeams);
  Robot robot(feed);
  robot.drive(400);
  std::map<int, std::pair<int, std::vector<CloudPoint>>> reader;
  EXPECT_GT(read_all(feed, reader), feed.cloud().keys().size());
  const std::size_t keys = feed.cloud().keys().size();
  ASSERT_GE(keys, 3U);
  for (std::size_t key = 0; key + 1 < keys; ++key) {
    EXPECT_EQ(reader[static_cast<int>(key)].second.size(), feed.cloud().points_of(key).size()) << key;
  }
  EXPECT_EQ(read_all(feed, reader), 0U) << "nothing is new";

  const std::vector<Point3> before = points_in_map(feed);
  feed.correct(robot.path({0.0, 0.01, 0.0}));
  EXPECT_EQ(read_all(feed, reader), 0U) << "1 cm is not worth it";
  EXPECT_NEAR(points_in_map(feed)[0].y_m, before[0].y_m + 0.01, 1e-6) << "but it counts";
  const Pose2 correction{0.5, -0.3, 0.1};
  feed.correct(robot.path(correction));
  EXPECT_GT(read_all(feed, reader), keys - 1);
  EXPECT_EQ(reader[0].first, 2) << "the second edition";
  const std::vector<Point3> after = points_in_map(feed);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); i += 100) {
    const Point2 moved = correction * Point2{before[i].x_m, before[i].y_m};
    EXPECT_NEAR(after[i].x_m, moved.x_m, 1e-4);
    EXPECT_NEAR(after[i].y_m, moved.y_m, 1e-4);
  }
}

TEST(CloudFeed, EndsWithAllThatIsReadyWhereTheFinalTrajectoryHasIt) {
  CloudFeed feed(params(), kBeams);
  Robot robot(feed);
  robot.drive(100);
  robot.drive(70, 35);
  robot.drive(1, 170);  // with this pose more scans are ready than one round takes
  const std::size_t before = feed.cloud().size();
  const Pose2 correction{0.5, -0.3, 0.1};
  const CloudKey first = feed.cloud().keys()[0];
  feed.finish(robot.path(correction));
  EXPECT_GT(feed.cloud().size(), before);
  const Pose2 moved = correction * first.map_T_key;
  EXPECT_LT(feed.cloud().keys()[0].map_T_key.distance_m(moved), 1e-6);
  EXPECT_EQ(feed.health().points, static_cast<std::int64_t>(feed.cloud().size()));
}

TEST(CloudFeed, BeginsAnewWithTheMapAndAKeyWhereTheRobotLeaps) {
  CloudFeed feed(params(), kBeams);
  Robot robot(feed);
  robot.drive(100);
  std::map<int, std::pair<int, std::vector<CloudPoint>>> reader;
  read_all(feed, reader);
  ASSERT_EQ(reader[0].first, 1);
  const std::size_t keys = feed.cloud().keys().size();
  robot.leap({5.0, 0.0, 0.0});
  robot.drive(5);
  EXPECT_EQ(feed.cloud().keys().size(), keys + 1);
  EXPECT_NEAR(feed.cloud().keys().back().map_T_key.x_m, 5.0 + 0.5 * 100 * 0.025, 0.05);
  robot.begin_map();
  robot.drive(10);
  EXPECT_EQ(feed.cloud().keys().size(), 1U) << "nothing of before";
  read_all(feed, reader);
  EXPECT_EQ(reader[0].first, 2) << "a reader sees that these are other points";
}

TEST(CloudFeed, SaysWhenItIsFull) {
  MappingParams small = params();
  small.cloud.points_max = 2'000;
  CloudFeed feed(small, kBeams);
  Robot robot(feed);
  robot.drive(20);
  EXPECT_GT(feed.health().points, 100);
  robot.drive(200);
  EXPECT_EQ(feed.health().points, 2'000);
  EXPECT_EQ(feed.health().used, 1.0);
  EXPECT_GT(feed.health().refused, 0);
}

TEST(CloudFeed, MessagesFitADatagramAndHoldPointsKeyAndEdition) {
  CloudFeed feed(params(), kBeams);
  Robot robot(feed);
  robot.drive(400);
  LcmParams silent;
  silent.url = "";
  LcmLink link(silent, 1'000);
  KeepingTap tap;
  link.set_tap(&tap);
  std::size_t full = 0;
  for (CloudPiece piece = feed.next_piece(kCloudPointsMax); !piece.points.empty();
       piece = feed.next_piece(kCloudPointsMax)) {
    ASSERT_EQ(link.publish(piece), Errc::kOk);
    const auto message = tap.last<bot_core::pointcloud_t>("ODOLESS_CLOUD");
    ASSERT_EQ(message.n_points, static_cast<int>(piece.points.size()));
    EXPECT_EQ(message.frame_id, "map");
    EXPECT_THAT(message.channel_names, ::testing::ElementsAre("key", "edition"));
    EXPECT_EQ(message.channels[0][0], static_cast<float>(piece.key));
    EXPECT_EQ(message.channels[1][0], static_cast<float>(piece.edition));
    EXPECT_NEAR(message.points[0][2], piece.points[0].z_m, 1e-6);
    EXPECT_LE(message.getEncodedSize(), static_cast<int>(kMessageMaxBytes));
    full += message.n_points == kCloudPointsMax ? 1 : 0;
  }
  EXPECT_GT(full, 0U) << "the largest message was tried";
}

TEST(CloudFeed, AllocatesNothingAfterConstruction) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer owns the heap functions";
  }
  CloudFeed feed(params(), kBeams);
  const std::vector<float> ranges_m(kBeams, 4.0F);
  const AllocationGuard guard;
  for (std::int64_t stamp_ns = 0; stamp_ns < 200 * kPeriod_ns; stamp_ns += kPeriod_ns) {
    feed.add(TiltRecord{.stamp_ns = stamp_ns, .angle_rad = tilt_rad(stamp_ns)});
    feed.add(ScanRecord{.stamp_ns = stamp_ns, .angle_step_rad = 0.01, .beams = kBeams}, ranges_m);
    Motion motion;
    motion.to_stamp_ns = stamp_ns;
    motion.odom_T_current = odom_T_scan(stamp_ns);
    feed.add(motion);
    PoseRecord pose;
    pose.stamp_ns = stamp_ns;
    pose.map_T_scan = motion.odom_T_current;
    feed.add(pose);
    feed.work();
    static_cast<void>(feed.next_piece(kCloudPointsMax));
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_GT(feed.cloud().size(), 10'000U);
}

}  // namespace
}  // namespace odoless
