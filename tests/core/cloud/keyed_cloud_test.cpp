#include "core/cloud/keyed_cloud.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "tests/core/cloud/cloud_support.hpp"

namespace odoless {
namespace {

/// The same without a bound: voxels in a map, sums in double precision, in the order in which they were first seen.
struct PlainKey {
  struct Sum {
    double x_m = 0.0, y_m = 0.0, z_m = 0.0;
    std::uint32_t returns = 0;
  };
  std::map<std::array<int, 3>, std::size_t> numbers{};
  std::vector<Sum> sums{};

  void add(const std::array<float, 3>& p, double voxel_m) {
    const auto index = [voxel_m](float value_m) {
      return static_cast<int>(std::floor(value_m * static_cast<float>(1.0 / voxel_m)));
    };
    const auto [known, is_new] = numbers.try_emplace({index(p[0]), index(p[1]), index(p[2])}, sums.size());
    sums.resize(numbers.size());
    Sum& sum = sums[known->second];
    sum = {sum.x_m + p[0], sum.y_m + p[1], sum.z_m + p[2], sum.returns + 1};
  }
};

std::array<float, 3> random_point(Rng& rng) {
  const auto value = [&rng] { return static_cast<float>(rng.uniform(-2.0, 2.0)); };
  return {value(), value(), value()};
}

CloudParams small_params() { return {.voxel_m = 0.2, .points_max = 100'000, .keys_max = 16, .key_voxels_max = 20'000}; }

TEST(KeyedCloud, KeepsTheMeanOfEachVoxelPerKey) {
  Rng rng(2);
  const CloudParams params = small_params();
  KeyedCloud cloud(params);
  std::vector<PlainKey> plain(4);
  for (std::size_t key = 0; key < plain.size(); ++key) {
    cloud.begin_key(static_cast<std::int64_t>(key), {});
    for (int i = 0; i < 10'000; ++i) {
      const std::array<float, 3> p = random_point(rng);
      ASSERT_TRUE(cloud.add(p[0], p[1], p[2]));
      plain[key].add(p, params.voxel_m);
    }
  }
  ASSERT_EQ(cloud.keys().size(), plain.size());
  for (std::size_t key = 0; key < plain.size(); ++key) {
    const std::span<const CloudPoint> points = cloud.points_of(key);
    ASSERT_EQ(points.size(), plain[key].sums.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PlainKey::Sum& sum = plain[key].sums[i];
      ASSERT_EQ(points[i].returns, sum.returns);
      EXPECT_NEAR(points[i].x_m, sum.x_m / sum.returns, 1e-5);
      EXPECT_NEAR(points[i].y_m, sum.y_m / sum.returns, 1e-5);
      EXPECT_NEAR(points[i].z_m, sum.z_m / sum.returns, 1e-5);
    }
  }
  EXPECT_EQ(cloud.refused(), 0);
}

// A corrected key takes its points along; the others stay.
TEST(KeyedCloud, FollowsACorrection) {
  KeyedCloud cloud(small_params());
  cloud.begin_key(0, {1.0, 2.0, 0.0});
  cloud.add(0.5F, 0.0F, 0.3F);
  cloud.begin_key(1, {4.0, 0.0, std::numbers::pi / 2.0});
  cloud.add(1.0F, 0.0F, 0.7F);
  const auto places = [&cloud] {
    std::vector<Point3> out;
    for_each_point(cloud, [&out](std::size_t, const Point3& p_map, std::uint32_t) { out.push_back(p_map); });
    return out;
  };
  EXPECT_NEAR(places()[0].x_m, 1.5, 1e-6);
  EXPECT_NEAR(places()[1].x_m, 4.0, 1e-6);
  EXPECT_NEAR(places()[1].y_m, 1.0, 1e-6);
  cloud.correct(1, {5.0, 0.0, 0.0});
  EXPECT_NEAR(places()[0].x_m, 1.5, 1e-6);
  EXPECT_NEAR(places()[1].x_m, 6.0, 1e-6);
  EXPECT_NEAR(places()[1].y_m, 0.0, 1e-6);
  EXPECT_NEAR(places()[1].z_m, 0.7, 1e-6);
}

TEST(KeyedCloud, FullPointsRefuseNewVoxelsAndStillAverage) {
  CloudParams params = small_params();
  params.points_max = 1'000;
  KeyedCloud cloud(params);
  cloud.begin_key(0, {});
  for (int i = 0; i < 1'500; ++i) {
    EXPECT_EQ(cloud.add(static_cast<float>(i), 0.05F, 0.05F), i < 1'000) << i;
  }
  EXPECT_EQ(cloud.size(), 1'000U);
  EXPECT_EQ(cloud.refused(), 500);
  EXPECT_TRUE(cloud.add(0.1F, 0.05F, 0.05F)) << "a voxel that is there already";
  EXPECT_EQ(cloud.points_of(0)[0].returns, 2U);
  cloud.begin_key(1, {});
  EXPECT_FALSE(cloud.add(0.1F, 0.05F, 0.05F)) << "another key's voxel is a new one";
}

TEST(KeyedCloud, FullKeysRefuseEverythingFromThenOn) {
  CloudParams params = small_params();
  params.keys_max = 2;
  KeyedCloud cloud(params);
  EXPECT_FALSE(cloud.add(0.0F, 0.0F, 0.0F)) << "no key has begun";
  for (int key = 0; key < 3; ++key) {
    cloud.begin_key(key, {});
    EXPECT_EQ(cloud.add(0.0F, 0.0F, 0.0F), key < 2);
  }
  EXPECT_EQ(cloud.keys().size(), 2U);
  EXPECT_EQ(cloud.refused(), 2);
  cloud.clear();
  cloud.begin_key(0, {});
  EXPECT_TRUE(cloud.add(0.0F, 0.0F, 0.0F));
}

TEST(KeyedCloud, RefusesWhatIsNoPlace) {
  KeyedCloud cloud(small_params());
  cloud.begin_key(0, {});
  const float kNan = std::numeric_limits<float>::quiet_NaN();
  const float kInf = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(cloud.add(kNan, 0.0F, 0.0F));
  EXPECT_FALSE(cloud.add(0.0F, kInf, 0.0F));
  EXPECT_FALSE(cloud.add(0.0F, 0.0F, -kInf));
  EXPECT_FALSE(cloud.add(1e30F, 0.0F, 0.0F));
  EXPECT_EQ(cloud.refused(), 4);
  EXPECT_EQ(cloud.size(), 0U);
}

}  // namespace
}  // namespace odoless
