#include "firmware/health/status.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <numbers>

namespace odoless {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

DaemonStatus lost_status() {
  DaemonStatus status;
  status.health.state = HealthState::kLost;
  status.health.reasons = kReasonDiverged | kReasonOverload;
  status.health.pose_probability = 0.125;
  status.health.lrf.rate_hz = 39.9;
  status.health.lrf.dropped = 7;
  PoseRecord pose;
  pose.stamp_ns = 1'500'000'000;
  pose.map_T_scan = {1.25, -2.5, std::numbers::pi / 2.0};
  pose.covariance = {0.04, 0.0, 0.0, 0.0, 0.09, 0.0, 0.0, 0.0, std::numbers::pi * std::numbers::pi / 32'400.0};
  status.pose = pose;
  status.map = {.width_m = 40.0, .height_m = 25.0, .cell_size_m = 0.05};
  status.poses_hz = 38.0;
  return status;
}

TEST(Status, TellsAPersonStatePoseMapAndRates) {
  const std::string text = status_text(lost_status());
  EXPECT_THAT(text, StartsWith("LOST: scans do not match the map, scans or records are dropped"));
  EXPECT_THAT(text,
              HasSubstr("pose: x 1.25 m, y -2.50 m, yaw 90.0 deg; standard deviations 0.20 m, 0.30 m, 1.0 deg\n"));
  EXPECT_THAT(text, HasSubstr("pose right within 0.5 m and 5 deg: 12.5 %\n"));
  EXPECT_THAT(text, HasSubstr("map: 40.0 m by 25.0 m, cells of 0.05 m"));
  EXPECT_THAT(text, HasSubstr("7 dropped"));
  EXPECT_THAT(text, HasSubstr("39.9 Hz"));
  EXPECT_THAT(text, HasSubstr("poses 38.0 Hz"));
}

TEST(Status, TellsAProgramTheSame) {
  const auto json = nlohmann::json::parse(status_json(lost_status()).dump());
  EXPECT_EQ(json["state"], "LOST");
  EXPECT_EQ(json["reasons"].size(), 2U);
  EXPECT_EQ(json["reasons"][0], "scans do not match the map");
  EXPECT_EQ(json["pose_probability"], 0.125);
  EXPECT_EQ(json["pose"]["stamp_s"], 1.5);
  EXPECT_EQ(json["pose"]["x_m"], 1.25);
  EXPECT_DOUBLE_EQ(json["pose"]["yaw_deg"], 90.0);
  EXPECT_DOUBLE_EQ(json["pose"]["sd_y_m"], 0.3);
  EXPECT_EQ(json["map"]["width_m"], 40.0);
  EXPECT_EQ(json["rates"]["scans_hz"], 39.9);
  EXPECT_EQ(json["scans"]["dropped"], 7);
  EXPECT_FALSE(json.contains("cloud"));
}

TEST(Status, TellsOfThePoseGraph) {
  DaemonStatus status = lost_status();
  EXPECT_THAT(status_text(status), ::testing::Not(HasSubstr("pose graph")));
  status.health.graph = {.submaps = 79,
                         .loop_closures = 221,
                         .used = 0.041,
                         .keyframes_left_out = 3,
                         .map_T_odom = {0.5, -0.25, std::numbers::pi}};
  EXPECT_THAT(status_text(status),
              HasSubstr("pose graph: 79 submaps, 221 loop closures, 4 % of its memory; 3 keyframes left out\n"));
  const auto json = nlohmann::json::parse(status_json(status).dump())["pose_graph"];
  EXPECT_EQ(json["submaps"], 79);
  EXPECT_EQ(json["loop_closures"], 221);
  EXPECT_EQ(json["memory_used"], 0.041);
  EXPECT_EQ(json["keyframes_left_out"], 3);
  EXPECT_DOUBLE_EQ(json["map_T_odom"]["yaw_deg"], 180.0);
}

TEST(Status, TellsHowASaveGetsOn) {
  DaemonStatus status = lost_status();
  EXPECT_THAT(status_text(status), ::testing::Not(HasSubstr("save:")));
  EXPECT_EQ(status_json(status)["save"]["state"], "none");
  status.save = {.state = SaveStatus::State::kSaving, .since_s = 1.25, .doing = "writing map.png"};
  EXPECT_THAT(status_text(status), HasSubstr("save: under way for 1.2 s: writing map.png\n"));
  EXPECT_EQ(status_json(status)["save"]["state"], "saving");
  status.save = {.state = SaveStatus::State::kFailed, .since_s = 3.0, .wrong = "/out: No space left on device"};
  EXPECT_THAT(status_text(status), HasSubstr("save: FAILED 3.0 s ago: /out: No space left on device\n"));
  EXPECT_EQ(status_json(status)["save"]["error"], "/out: No space left on device");
}

TEST(Status, TellsOfTheWorldFile) {
  DaemonStatus status = lost_status();
  EXPECT_THAT(status_text(status), ::testing::Not(HasSubstr("world:")));
  EXPECT_FALSE(status_json(status).contains("world"));
  status.world = {.file = "/w", .uuid = "1-2", .revision = 7, .session = 3, .keyframes = 80, .age_s = 0.5};
  EXPECT_THAT(status_text(status),
              HasSubstr("world: /w, 1-2, revision 7, session 3: 80 keyframes, written 0.5 s ago\n"));
  EXPECT_EQ(status_json(status)["world"]["uuid"], "1-2");
  EXPECT_EQ(status_json(status)["world"]["revision"], 7);
  status.world->error = ENOSPC;
  status.world->reason = "No space left on device";
  status.world->not_written = 6;
  status.world->scans_lost = 40;
  EXPECT_THAT(status_text(status), HasSubstr("world: /w cannot be written for 0 s: No space left on device; 6 "
                                             "keyframes wait; lost: 0 keyframes, the poses of 40 scans\n"));
  EXPECT_EQ(status_json(status)["world"]["error"], "No space left on device");
}

TEST(Status, BeforeTheFirstPoseThereIsNone) {
  EXPECT_THAT(status_text({}), HasSubstr("pose: none yet\n"));
  EXPECT_TRUE(status_json({})["pose"].is_null());
  EXPECT_EQ(status_json({})["state"], "INIT");
}

}  // namespace
}  // namespace odoless
