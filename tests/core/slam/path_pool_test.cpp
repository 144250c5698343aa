#include "core/slam/path_pool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

StampedPose pose_of(int update, int particle) {
  return {.stamp_ns = update, .map_T_scan = {static_cast<double>(particle), static_cast<double>(update), 0.0}};
}

std::vector<int> random_copies(int particles, int wanted, Rng& rng) {
  std::vector<int> copies(static_cast<std::size_t>(particles), 0);
  for (int i = 0; i < wanted; ++i) {
    const auto bound = static_cast<std::uint32_t>(particles);
    ++copies[std::min(rng.below(bound), rng.below(bound))];
  }
  return copies;
}

/// The pool beside paths that are copied as a whole.
class PathsTwice {
 public:
  PathsTwice(int records_max, int particles) : pool(records_max, particles), wanted_(particles) {}

  void update(bool resample, Rng& rng) {
    const std::vector<int> copies = random_copies(static_cast<int>(copied.size()), wanted_, rng);
    pool.next_update();
    if (resample) {
      pool.retain(copies);
    }
    for (std::size_t i = 0; i < copied.size(); ++i) {
      if (!resample || copies[i] > 0) {
        pool.append(static_cast<int>(i), pose_of(updates_, static_cast<int>(i)));
        copied[i].push_back(pose_of(updates_, static_cast<int>(i)));
      }
    }
    if (resample) {
      pool.branch(copies);
      std::vector<std::vector<StampedPose>> next;
      for (std::size_t i = 0; i < copies.size(); ++i) {
        next.insert(next.end(), static_cast<std::size_t>(copies[i]), copied[i]);
      }
      copied = next;
    }
    ++updates_;
  }

  PathPool pool;
  std::vector<std::vector<StampedPose>> copied = std::vector<std::vector<StampedPose>>(1);

 private:
  int wanted_;
  int updates_ = 0;
};

TEST(PathPool, GivesEveryParticleThePathThatACopyOfItsOwnWouldHold) {
  Rng rng(2);
  PathsTwice paths(5000, 12);
  for (int update = 0; update < 300; ++update) {
    paths.update(update == 0 || rng.below(3) == 0, rng);
    for (std::size_t i = 0; i < paths.copied.size(); ++i) {
      std::vector<StampedPose> path;
      paths.pool.write_path(static_cast<int>(i), path);
      ASSERT_EQ(path.size(), paths.copied[i].size());
      for (std::size_t k = 0; k < path.size(); ++k) {
        ASSERT_EQ(path[k].stamp_ns, paths.copied[i][k].stamp_ns);
        ASSERT_EQ(path[k].map_T_scan.x_m, paths.copied[i][k].map_T_scan.x_m);
      }
    }
  }
  EXPECT_EQ(paths.pool.thinned(), 0);
}

TEST(PathPool, KeepsOneRecordPerUpdateWhenAllDescendFromOneParticle) {
  PathPool pool(1000, 4);
  pool.next_update();
  pool.append(0, pose_of(0, 0));
  pool.branch(std::vector<int>{4});
  pool.next_update();
  for (int i = 0; i < 4; ++i) {
    pool.append(i, pose_of(1, i));
  }
  EXPECT_EQ(pool.records_used(), 5);
  pool.retain(std::vector<int>{0, 0, 4, 0});
  EXPECT_EQ(pool.records_used(), 2);
}

/// Whatever the resamplings, a full pool thins and never fails; the ends of the path stay, and what stays is true.
TEST(PathPool, ThinsThePastWhenItIsFull) {
  for (const int particles : {1, 2, 7, 16}) {
    for (const std::uint32_t resample_every : {1U, 4U, 1'000'000U}) {
      Rng rng(5);
      PathsTwice paths(16 * particles, particles);
      for (int update = 0; update < 500; ++update) {
        paths.update(update == 0 || rng.below(resample_every) == 0, rng);
        for (std::size_t i = 0; i < paths.copied.size(); ++i) {
          std::vector<StampedPose> path;
          paths.pool.write_path(static_cast<int>(i), path);
          ASSERT_FALSE(path.empty());
          ASSERT_EQ(path.front().stamp_ns, 0);
          ASSERT_EQ(path.back().stamp_ns, update);
          for (const StampedPose& pose : path) {
            const StampedPose& truth = paths.copied[i][static_cast<std::size_t>(pose.stamp_ns)];
            ASSERT_EQ(pose.map_T_scan.x_m, truth.map_T_scan.x_m);
          }
          ASSERT_TRUE(std::is_sorted(path.begin(), path.end(), [](const StampedPose& a, const StampedPose& b) {
            return a.stamp_ns < b.stamp_ns;
          }));
        }
      }
      EXPECT_GT(paths.pool.thinned(), 0);
    }
  }
}

// A pool of many times what an update may append is thinned, and a long path that is lost given back, over many
// updates.
TEST(PathPool, ThinsAndGivesBackALittlePerUpdate) {
  constexpr int kRecords = 3000;
  constexpr int kLooks = 16 * 2;  // per particle that may append
  PathPool pool(kRecords, 2);
  pool.next_update();
  pool.append(0, pose_of(0, 0));
  pool.branch(std::vector<int>{2});
  int update = 1;
  const auto step = [&] {
    const std::int64_t before = pool.thinned();
    pool.next_update();
    EXPECT_LE(pool.thinned() - before, kLooks);
    pool.append(0, pose_of(update, 0));
    pool.append(1, pose_of(update++, 1));
  };
  while (pool.thinned() == 0) {
    step();
  }
  EXPECT_GT(pool.records_used(), kRecords * 7 / 8 - kLooks);
  for (int i = 0; i < 200; ++i) {
    step();
  }
  const int full = pool.records_used();
  pool.retain(std::vector<int>{0, 2});
  EXPECT_GE(pool.records_used(), full - kLooks);
  pool.branch(std::vector<int>{0, 2});
  for (int i = 0; i < 200; ++i) {
    step();
  }
  EXPECT_LT(pool.records_used(), full / 2 + 500);
}

TEST(PathPool, ThinsOldRecordsMoreThanNewOnes) {
  Rng rng(1);
  PathsTwice paths(64, 1);
  for (int update = 0; update < 1000; ++update) {
    paths.update(false, rng);
  }
  std::vector<StampedPose> path;
  paths.pool.write_path(0, path);
  ASSERT_GT(path.size(), 32U);
  EXPECT_GT(path[1].stamp_ns - path[0].stamp_ns, 20);
  EXPECT_EQ(path.back().stamp_ns - path[path.size() - 10].stamp_ns, 9);
}

}  // namespace
}  // namespace odoless
