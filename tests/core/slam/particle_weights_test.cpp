#include "core/slam/particle_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

std::vector<double> random_weights(std::size_t size, Rng& rng) {
  std::vector<double> log_weights(size);
  for (double& log_weight : log_weights) {
    log_weight = rng.uniform(-8.0, 0.0);
  }
  std::vector<double> weights(size);
  normalise_weights(log_weights, weights);
  return weights;
}

TEST(ParticleWeights, AreProportionalToTheExponentialsHoweverSmallTheseAre) {
  const std::vector<double> log_weights{-5000.0, -5001.0, -9000.0};
  std::vector<double> weights(3);
  normalise_weights(log_weights, weights);
  EXPECT_NEAR(weights[0], 1.0 / (1.0 + std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(weights[1] / weights[0], std::exp(-1.0), 1e-12);
  EXPECT_EQ(weights[2], 0.0);
}

TEST(ParticleWeights, CountEffectiveParticles) {
  EXPECT_NEAR(effective_particles(std::vector<double>(8, 1.0 / 8.0)), 8.0, 1e-12);
  EXPECT_NEAR(effective_particles(std::vector<double>{0.0, 1.0, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(effective_particles(std::vector<double>{0.5, 0.5, 0.0}), 2.0, 1e-12);
}

TEST(SystematicCopies, GiveEachItsShareRoundedUpOrDownAndAllThatAreWanted) {
  Rng rng(8);
  for (int round = 0; round < 500; ++round) {
    const std::size_t size = 1 + rng.below(60);
    const auto wanted = static_cast<int>(1 + rng.below(120));
    const std::vector<double> weights = random_weights(size, rng);
    std::vector<int> copies(size, -1);
    systematic_copies(weights, wanted, rng.uniform(), copies);
    EXPECT_EQ(std::accumulate(copies.begin(), copies.end(), 0), wanted);
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(copies[i], weights[i] * wanted, 1.0 + 1e-9);
      EXPECT_GE(copies[i], 0);
    }
  }
}

TEST(SystematicCopies, AreUnbiased) {
  const std::vector<double> weights{0.07, 0.61, 0.0, 0.32};
  std::vector<double> mean(4, 0.0);
  constexpr int kOffsets = 10'000;
  for (int i = 0; i < kOffsets; ++i) {
    std::vector<int> copies(4);
    systematic_copies(weights, 5, (i + 0.5) / kOffsets, copies);
    for (std::size_t k = 0; k < 4; ++k) {
      mean[k] += static_cast<double>(copies[k]) / kOffsets;
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(mean[k], 5.0 * weights[k], 1e-3);
  }
}

TEST(SystematicCopies, NeverGoToAParticleWithoutWeight) {
  for (const double offset : {0.0, 0.5, 1.0 - 0x1p-32}) {
    std::vector<int> copies(4);
    systematic_copies(std::vector<double>{0.0, 1.0 - 1e-16, 0.0, 0.0}, 7, offset, copies);
    EXPECT_EQ(copies, (std::vector<int>{0, 7, 0, 0}));
  }
}

TEST(DropWeakestHalf, KeepsTheStrongestInProportion) {
  std::vector<double> weights{0.1, 0.4, 0.05, 0.2, 0.25};
  std::vector<int> scratch(5);
  drop_weakest_half(weights, scratch);
  EXPECT_EQ(weights[0], 0.0);
  EXPECT_EQ(weights[2], 0.0);
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-12);
  EXPECT_NEAR(weights[1] / weights[3], 2.0, 1e-12);
}

TEST(DropWeakestHalf, DropsHalfOfEqualsToo) {
  std::vector<double> weights(6, 1.0 / 6.0);
  std::vector<int> scratch(6);
  drop_weakest_half(weights, scratch);
  EXPECT_NEAR(effective_particles(weights), 3.0, 1e-12);
  EXPECT_GT(weights[0], 0.0);
}

}  // namespace
}  // namespace odoless
