#include "core/optimize/nelder_mead.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr SearchPoint kSize{0.1, 0.1, 0.1};

TEST(NelderMead, ClimbsToTheTopOfSkewedQuadratics) {
  Rng rng(1);
  for (int round = 0; round < 50; ++round) {
    const SearchPoint top{rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)};
    const double skew = rng.uniform(-0.8, 0.8);
    const auto score = [&](const SearchPoint& p) {
      const double x = p[0] - top[0];
      const double y = p[1] - top[1];
      const double z = p[2] - top[2];
      return 3.0 - x * x - 4.0 * y * y - z * z - skew * (x * y + y * z);
    };
    const SearchPoint start{};
    const ScoredPoint best = nelder_mead({start, score(start)}, kSize, 300, score);
    EXPECT_EQ(best.score, score(best.point));
    EXPECT_NEAR(best.score, 3.0, 1e-6);
    for (std::size_t k = 0; k < top.size(); ++k) {
      EXPECT_NEAR(best.point[k], top[k], 1e-3);
    }
  }
}

TEST(NelderMead, KeepsItsBudgetAndNeverEndsLowerThanItBegan) {
  Rng rng(2);
  for (int evaluations = 0; evaluations < 120; ++evaluations) {
    int calls = 0;
    double highest = 0.0;
    const auto noise = [&](const SearchPoint&) {  // shrinks often
      ++calls;
      const double score = rng.uniform();
      highest = std::max(highest, score);
      return score;
    };
    const ScoredPoint best = nelder_mead({{}, 0.5}, kSize, evaluations, noise);
    EXPECT_EQ(best.score, std::max(0.5, highest));
    EXPECT_GE(calls, evaluations);
    EXPECT_LE(calls, std::max(3, evaluations + 4));
  }
}

TEST(NelderMead, AsksItsDeadlineBeforeTheFirstStepAndEveryEight) {
  for (int questions = 0; questions < 4; ++questions) {
    int calls = 0;
    int left = questions;
    const Deadline deadline([](const void* context) { return (*static_cast<int*>(const_cast<void*>(context)))-- == 0; },
                            &left);
    const ScoredPoint best = nelder_mead(
        {{}, 0.5}, kSize, 1000,
        [&](const SearchPoint& p) {
          ++calls;
          return 0.4 - p[0];
        },
        deadline);
    EXPECT_GE(calls, 3 + questions * 8);
    EXPECT_LE(calls, 3 + questions * 8 * 5);
    EXPECT_GE(best.score, 0.5);
  }
}

}  // namespace
}  // namespace odoless
