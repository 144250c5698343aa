#include "core/cloud/cloud_mapper.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/cloud/level_scan.hpp"
#include "tests/core/cloud/cloud_support.hpp"
#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

constexpr int kMapperBeams = 1081;

CloudParams small_mapper() { return {.voxel_m = 0.1, .points_max = 50'000, .keys_max = 8, .key_voxels_max = 20'000}; }

// Whatever odometry says of the way, a point is where the newest key and the motion since put it.
TEST(CloudMapper, BeginsAKeyAfterSomeTravelAndHangsPointsOnIt) {
  CloudMapper mapper(small_mapper(), TiltMount(TiltMountParams{}), kMapperBeams);
  const ScanFrame scan = test::scan_of(std::vector<float>(kMapperBeams, 3.0F));
  const std::vector<double> tilts_rad(kMapperBeams, 0.1);
  const Pose2 map_T_odom{10.0, 0.0, 0.5};
  for (const double x_m : {0.0, 1.0, 1.9, 2.1, 3.0}) {
    mapper.add(scan, tilts_rad, {{x_m, 0.0, 0.0}, {x_m, 0.0, 0.0}}, map_T_odom);
  }
  ASSERT_EQ(mapper.cloud().keys().size(), 2U);
  const Pose2 second = map_T_odom * Pose2{2.1, 0.0, 0.0};
  EXPECT_NEAR(mapper.cloud().keys()[1].map_T_key.x_m, second.x_m, 1e-12);
  EXPECT_NEAR(mapper.cloud().keys()[1].map_T_key.yaw_rad, second.yaw_rad, 1e-12);
  mapper.add(scan, tilts_rad, {{3.0, 0.0, 1.6}, {3.0, 0.0, 1.6}}, map_T_odom);
  EXPECT_EQ(mapper.cloud().keys().size(), 3U) << "a turn begins one too";
  mapper.reset();
  mapper.add(scan, tilts_rad, {{3.0, 0.0, 1.6}, {3.0, 0.0, 1.6}}, map_T_odom);
  EXPECT_EQ(mapper.cloud().keys().size(), 4U);
}

TEST(CloudMapper, LeavesOutWhatIsTooFar) {
  CloudParams params = small_mapper();
  params.range_max_m = 5.0;
  CloudMapper mapper(params, TiltMount(TiltMountParams{}), kMapperBeams);
  std::vector<float> ranges_m(kMapperBeams, 5.1F);
  ranges_m[7] = 4.9F;
  mapper.add(test::scan_of(ranges_m), std::vector<double>(kMapperBeams, 0.0), {}, {});
  EXPECT_EQ(mapper.cloud().size(), 1U);
}

// With keys, points and voxels running full meanwhile.
TEST(CloudMapper, AllocatesNothingAfterConstruction) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer owns the heap functions";
  }
  Rng rng(4);
  CloudMapper mapper(small_mapper(), TiltMount(test::random_mount(rng)), kMapperBeams);
  LevelScan level(mapper.mount(), {}, kMapperBeams);
  const ScanFrame scan = test::scan_of(test::random_ranges_m(rng, kMapperBeams));
  const std::vector<double> tilts_rad(kMapperBeams, 0.1);
  const AllocationGuard guard;
  for (int i = 0; i < 200; ++i) {
    const Pose2 first{0.1 * i, 0.05 * i, 0.02 * i};
    mapper.add(scan, tilts_rad, {first, first * Pose2{0.01, 0.0, 0.01}}, {});
    static_cast<void>(level.make(scan, tilts_rad));
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_GT(mapper.cloud().refused(), 0);
}

}  // namespace
}  // namespace odoless
