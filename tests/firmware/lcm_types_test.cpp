// Fingerprints: a type's members by name, type and order. Other robots' programs know ours by them.
#include <gtest/gtest.h>

#include <bot_core/joint_state_t.hpp>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pointcloud_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/raw_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <bot_core/sensor_status_t.hpp>
#include <cstdint>
#include <occ_map/pixel_map_t.hpp>
#include <odoless/correction_t.hpp>
#include <odoless/health_t.hpp>
#include <odoless/map_tile_t.hpp>
#include <odoless/motion_t.hpp>
#include <odoless/pose_estimate_t.hpp>
#include <odoless/scan_times_t.hpp>
#include <odoless/world_t.hpp>

#include "core/graph/map_correction.hpp"
#include "core/motion/motion.hpp"
#include "firmware/records/health.hpp"

namespace odoless {
namespace {

template <class Message>
std::uint64_t fingerprint() {
  return static_cast<std::uint64_t>(Message::getHash());
}

TEST(LcmTypes, AreThoseThatOtherRobotsSpeak) {
  EXPECT_EQ(fingerprint<bot_core::planar_lidar_t>(), 0xe3d17423180b5e8dU);
  EXPECT_EQ(fingerprint<bot_core::pose_t>(), 0x2e16efb052b0105eU);
  EXPECT_EQ(fingerprint<bot_core::rigid_transform_t>(), 0xea9ffbf2acc5c5aeU);
  EXPECT_EQ(fingerprint<bot_core::pointcloud_t>(), 0x0d89dc76eb295069U);
  EXPECT_EQ(fingerprint<bot_core::raw_t>(), 0x30571b45b804c18eU);
  EXPECT_EQ(fingerprint<bot_core::joint_state_t>(), 0x3e377b4cebc593a4U);
  EXPECT_EQ(fingerprint<bot_core::sensor_status_t>(), 0x22bd8eb19e834aadU);
  EXPECT_EQ(fingerprint<occ_map::pixel_map_t>(), 0xe4b099a4cce13107U);
}

// A change here breaks every log and every program that reads our messages: make another type instead.
TEST(LcmTypes, OfOurOwnStayAsTheyAre) {
  EXPECT_EQ(fingerprint<motion_t>(), 0x2f1a1ea764ccd9dcU);
  EXPECT_EQ(fingerprint<pose_estimate_t>(), 0xf340b4c06f2bb4a3U);
  EXPECT_EQ(fingerprint<map_tile_t>(), 0x666fae7f76fce32dU);
  EXPECT_EQ(fingerprint<health_t>(), 0x4c10d772a2532e6aU);
  EXPECT_EQ(fingerprint<correction_t>(), 0xe1ad0c3a4f32131U);
  EXPECT_EQ(fingerprint<scan_times_t>(), 0x3cbb640eb6403f95U);
  EXPECT_EQ(fingerprint<world_t>(), 0xd6b82b0036f604bfU);
}

TEST(LcmTypes, NameHealthAsTheRecordsDo) {
  EXPECT_EQ(correction_t::LOOP, static_cast<int>(CorrectionCause::kLoop));
  EXPECT_EQ(correction_t::FOUND, static_cast<int>(CorrectionCause::kFound));
  EXPECT_EQ(world_t::SURE, static_cast<int>(WorldPlaceKnown::kSure));
  EXPECT_EQ(health_t::FAULT, static_cast<int>(HealthState::kFault));
  EXPECT_EQ(health_t::LOST, static_cast<int>(HealthState::kLost));
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_STUCK), kReasonStuck);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_DIVERGED), kReasonDiverged);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_NOT_REAL_TIME), kReasonNotRealTime);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_STAGE_SILENT), kReasonStageSilent);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_PAUSED), kReasonPaused);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_STOPPED), kReasonStopped);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_GPIO), kReasonGpio);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_CLOUD_FULL), kReasonCloudFull);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_BAD_TILT), kReasonBadTilt);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_BAD_MOTIONS), kReasonBadMotions);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_NOT_AUTHENTIC), kReasonNotAuthentic);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_SWEEP), kReasonSweep);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_NOT_IN_WORLD), kReasonNotInWorld);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_DRIFT), kReasonDrift);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_TILT), kReasonTilt);
  EXPECT_EQ(static_cast<std::uint32_t>(health_t::REASON_NOT_LEVEL), kReasonNotLevel);
}

TEST(LcmTypes, NameTheFlagsOfAMotionAsItDoes) {
  EXPECT_EQ(motion_t::MATCHED, static_cast<int>(kMatched));
  EXPECT_EQ(motion_t::CONVERGED, static_cast<int>(kConverged));
  EXPECT_EQ(motion_t::ESCALATED, static_cast<int>(kEscalated));
  EXPECT_EQ(motion_t::DEADLINE_HIT, static_cast<int>(kDeadlineHit));
  EXPECT_EQ(motion_t::JOLTED, static_cast<int>(kJolted));
  EXPECT_EQ(motion_t::REJECTED, static_cast<int>(kRejected));
}

}  // namespace
}  // namespace odoless
