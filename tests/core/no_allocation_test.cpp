#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <thread>
#include <vector>

#include "core/motion/scan_matching_motion_model.hpp"
#include "core/odometry/laser_odometry.hpp"
#include "core/slam/lslam.hpp"
#include "core/slam/slam.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/simulated_room.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {
namespace {

class NoAllocation : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!AllocationGuard::kWorks) {
      GTEST_SKIP() << "the sanitizer owns the heap functions";
    }
  }
};

struct alignas(128) Wide {
  char bytes[128];
};

TEST_F(NoAllocation, GuardNoticesEveryKindOfHeapCall) {
  const AllocationGuard guard;
  long calls = 0;
  const auto expect_new_calls = [&](const char* what) {
    EXPECT_GT(guard.calls(), calls) << what;
    calls = guard.calls();
  };
  void* volatile block = std::malloc(10);
  expect_new_calls("malloc");
  block = std::realloc(block, 1000);
  expect_new_calls("realloc");
  std::free(block);
  expect_new_calls("free");
  block = std::calloc(3, 3);
  expect_new_calls("calloc");
  std::free(block);
  calls = guard.calls();
  block = std::aligned_alloc(64, 64);
  expect_new_calls("aligned_alloc");
  std::free(block);
  calls = guard.calls();
  block = ::operator new(7);
  expect_new_calls("operator new");
  ::operator delete(block);
  expect_new_calls("operator delete");
  const auto wide = std::make_unique<Wide>();
  expect_new_calls("aligned operator new");
  std::vector<int> grown;
  grown.push_back(1);
  expect_new_calls("vector");
}

TEST_F(NoAllocation, MotionsCompose) {
  Motion sum;
  Motion motion = Motion::between(0, 1, {0.5, 0.0, 0.1});
  motion.alternatives[0] = {{0.2, 0.0, 0.1}, -1.0, {}};
  motion.alternative_count = 1;
  const AllocationGuard guard;
  for (int i = 0; i < 20; ++i) {
    sum = sum.then(motion);
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(sum.alternative_count, static_cast<int>(Motion::kAlternativesMax));
}

TEST_F(NoAllocation, GuardCountsItsOwnThreadAlone) {
  std::atomic<int> stage = 0;
  std::thread other([&stage] {
    while (stage != 1) {
    }
    const AllocationGuard guard;
    ::operator delete(::operator new(100));
    EXPECT_EQ(guard.calls(), 2);
    stage = 2;
  });
  const AllocationGuard guard;
  stage = 1;
  while (stage != 2) {
  }
  EXPECT_EQ(guard.calls(), 0);
  other.join();
}

TEST_F(NoAllocation, MotionModelAllocatesNothing) {
  const ScanMatchingMotionModel model({});
  Rng rng(1);
  const AllocationGuard guard;
  Pose2 pose;
  for (int i = 0; i < 100; ++i) {
    pose = model.sample(pose, {0.1, 0.0, 0.01}, 0.3, rng);
  }
  EXPECT_EQ(guard.calls(), 0);
}

TEST_F(NoAllocation, RebuildAndMatchAllocateNothingEvenWhenTheyTryAgain) {
  const MatcherParams params;
  MatchReference reference(params.reference, params.points_max);
  NdtMatcher matcher(params);
  Rng rng(1);
  const ScanFrame here = sweep(cluttered_room(), {}, {}, rng);
  const ScanFrame near = sweep(cluttered_room(), {}, {0.5, 0.2, 0.3}, rng);
  const ScanFrame elsewhere = sweep(pillar_field(), {}, {}, rng);
  const ScanFrame blind = sweep(SimulatedScene{}, {}, {}, rng);
  const PlacedScan placed{&here, {}};
  const AllocationGuard guard;
  const Errc error = reference.rebuild({&placed, 1});
  const bool easy = matcher.match(reference, near, {}, {}, rng).value().converged;
  const bool escalated = matcher.match(reference, elsewhere, {}, {}, rng).value().escalated;
  const bool refused = matcher.match(reference, blind, {}, {}, rng).ok();
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(error, Errc::kOk);
  EXPECT_TRUE(easy);
  EXPECT_TRUE(escalated);
  EXPECT_FALSE(refused);
}

TEST_F(NoAllocation, LaserOdometryAllocatesNothingAlsoForKeyScansAndBlindOnes) {
  LaserOdometry odometry({.key_scans = 5}, {}, {}, {});
  Rng rng(1);
  long calls = 0;
  for (int i = 0; i < 30; ++i) {
    const Pose2 map_T_scan{-1.0 + 0.05 * i, 0.3, 0.2 * i};
    ScanFrame scan =
        sweep(i % 10 == 7 ? SimulatedScene{} : cluttered_room(), {}, map_T_scan, rng, std::int64_t{i} * 100'000'000);
    const AllocationGuard guard;
    const bool matched = odometry.process(scan, {}, rng).matched();
    calls += guard.calls();
    EXPECT_EQ(matched, i > 0 && i % 10 != 7) << i;
  }
  EXPECT_EQ(calls, 0);
}

TEST_F(NoAllocation, LslamUpdateAllocatesNothingEvenWithFullPools) {
  LslamParams params;
  params.particles = 30;
  params.path_records_max = 1024;
  params.refine_steps = 1;
  for (const int tiles_max : {16, 400, 20'000}) {
    params.grid = {.resolution_m = 0.1, .width_m = 10.0, .height_m = 10.0, .tiles_max = tiles_max};
    Lslam lslam(params, 1);
    SimulatedRoom room(2);
    long calls = 0;
    std::int64_t refused = 0;
    for (int i = 0; i < 50; ++i) {
      room.step();
      const AllocationGuard guard;
      refused += lslam.update(room.motion(), room.scan()).refused_tiles;
      static_cast<void>(lslam.estimate());
      calls += guard.calls();
    }
    const AllocationGuard guard;
    lslam.reset({});
    EXPECT_EQ(calls + guard.calls(), 0) << tiles_max;
    EXPECT_EQ(refused > 0, tiles_max < 20'000) << tiles_max;
  }
}

TEST_F(NoAllocation, SlamWithBothLevelsAllocatesNothing) {
  SlamParams params;
  params.low.particles = 10;
  params.high.particles = 10;
  params.high.segment_updates = 5;
  params.low.grid = {.resolution_m = 0.1, .width_m = 10.0, .height_m = 10.0, .tiles_max = 20'000};
  for (const int tiles_max : {16, 20'000}) {
    params.high.grid = params.low.grid;
    params.high.grid.tiles_max = tiles_max;
    Slam slam(params, {.beams_max = 60, .range_max_m = 20.0}, 1);
    SimulatedRoom room(2);
    long calls = 0;
    for (int i = 0; i < 60; ++i) {
      room.step();
      const AllocationGuard guard;
      static_cast<void>(slam.update(room.motion(), room.scan()));
      slam.work();
      static_cast<void>(slam.estimate());
      static_cast<void>(slam.map_T_scan());
      calls += guard.calls();
    }
    EXPECT_EQ(calls, 0) << tiles_max;
    EXPECT_EQ(slam.high()->report().refused_tiles > 0, tiles_max == 16);
  }
}

}  // namespace
}  // namespace odoless
