#include "core/slam/kld_sampling.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace odoless {
namespace {

int bins_of(const std::vector<Pose2>& poses, const std::vector<double>& weights) {
  return KldSampling(100).bins(poses, weights);
}

// Fox's equation 7, worked out by hand for the normal quantile of 0.99: k bins, error, particles.
TEST(KldSampling, AsksForWhatFoxsEquationSays) {
  EXPECT_EQ(KldSampling::particles_for(0, 0.1), 1);
  EXPECT_EQ(KldSampling::particles_for(1, 0.1), 1);
  EXPECT_EQ(KldSampling::particles_for(2, 0.1), 33);
  EXPECT_EQ(KldSampling::particles_for(20, 0.1), 182);
  EXPECT_EQ(KldSampling::particles_for(20, 0.05), 363);
  EXPECT_GT(KldSampling::particles_for(100, 1e-300), 100'000'000) << "an error of nearly 0 asks for very many";
}

// Half the chi-squared quantile of 0.99 over the error: tables have 6.635, 30.578 and 124.116 for 1, 15 and 90.
TEST(KldSampling, IsNearTheChiSquaredQuantile) {
  for (const auto& [free, quantile] : {std::pair(1, 6.635), std::pair(15, 30.578), std::pair(90, 124.116)}) {
    EXPECT_NEAR(KldSampling::particles_for(free + 1, 0.01), quantile / 0.02, 0.02 * quantile / 0.02) << free;
  }
}

TEST(KldSampling, CountsBinsAndNotParticles) {
  const std::vector<double> even(4, 0.25);
  EXPECT_EQ(bins_of({{0.01, 0.01, 0.001}, {0.09, 0.09, 0.03}, {0.05, 0.02, 0.01}, {0.02, 0.05, 0.02}}, even), 1);
  EXPECT_EQ(bins_of({{0.01, 0.01, 0.0}, {0.11, 0.01, 0.0}, {0.01, 0.11, 0.0}, {0.01, 0.01, 0.05}}, even), 4);
  EXPECT_EQ(bins_of({{-0.01, 0.0, 0.0}, {0.01, 0.0, 0.0}, {-0.01, 0.0, 0.0}, {0.01, 0.0, 0.0}}, even), 2);
}

TEST(KldSampling, LeavesOutWhatAResamplingWouldRatherDrop) {
  EXPECT_EQ(bins_of({{0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}}, {0.8, 0.2}), 1);
  EXPECT_EQ(bins_of({{0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}}, {0.7, 0.3}), 2);
}

TEST(KldSampling, ACopyHasRoomToo) {
  const KldSampling kld(2);
  KldSampling copy = kld;
  EXPECT_EQ(copy.bins(std::vector<Pose2>{{}, {1.0, 0.0, 0.0}}, std::vector<double>{0.5, 0.5}), 2);
}

TEST(KldSampling, TakesPosesThatAreVeryFar) {
  EXPECT_EQ(bins_of({{1e300, -1e300, 1e300}, {-1e300, 1e300, 0.0}}, {0.5, 0.5}), 2);
}

}  // namespace
}  // namespace odoless
