#include "core/optimize/differential_evolution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

namespace odoless {

static void PrintTo(DeStrategy strategy, std::ostream* out) {
  *out << kDeStrategyNames[static_cast<std::size_t>(strategy)];
}

namespace {

constexpr SearchBox kBox{{1.0, -2.0, 0.5}, {2.0, 3.0, 1.5}};
constexpr SearchPoint kTop{1.7, -3.1, 1.2};

double squares(const SearchPoint& a, const SearchPoint& b, double scale) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += (a[k] - b[k]) * (a[k] - b[k]) / (scale * scale);
  }
  return sum;
}

double one_hill(const SearchPoint& p) { return 1.0 - squares(p, kTop, 2.0); }

// A narrow top, a broad and lower one at the other end of the box, and ripples everywhere.
double many_hills(const SearchPoint& p) {
  const double ripples = std::cos(9.0 * (p[0] - kTop[0])) + std::cos(9.0 * (p[1] - kTop[1]));
  return std::exp(-squares(p, kTop, 0.7)) + 0.7 * std::exp(-squares(p, {-0.5, 0.5, -0.5}, 1.2)) + 0.03 * ripples;
}

void offer_halton(DifferentialEvolution& evolution, int count, double (*score)(const SearchPoint&)) {
  evolution.begin(kBox);
  for (int i = 0; i < count; ++i) {
    const SearchPoint point = kBox.at(halton(i));
    evolution.offer(point, score(point));
  }
}

bool inside(const SearchPoint& p) {
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (!(std::abs(p[k] - kBox.centre[k]) <= kBox.half_size[k] + 1e-12)) {
      return false;
    }
  }
  return true;
}

class EachStrategy : public ::testing::TestWithParam<DeStrategy> {
 protected:
  [[nodiscard]] static DeParams params() { return {.strategy = GetParam()}; }
};

TEST_P(EachStrategy, FindsTheOnlyHill) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    DifferentialEvolution evolution(params());
    Rng rng(seed);
    offer_halton(evolution, 200, one_hill);
    EXPECT_EQ(evolution.evolve(one_hill, 6000, {}, rng), StopReason::kBudget);
    EXPECT_LT(std::sqrt(squares(evolution.best().point, kTop, 1.0)), 1e-3) << seed;
  }
}

TEST_P(EachStrategy, FindsTheHighestOfManyHills) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    DifferentialEvolution evolution(params());
    Rng rng(seed);
    offer_halton(evolution, 400, many_hills);
    EXPECT_EQ(evolution.evolve(many_hills, 6000, {}, rng), StopReason::kBudget);
    EXPECT_LT(std::sqrt(squares(evolution.best().point, kTop, 1.0)), 0.02) << seed;
  }
}

TEST_P(EachStrategy, AsksExactlyItsBudgetAlwaysInTheBoxAndNeverGetsWorse) {
  DifferentialEvolution evolution(params());
  Rng rng(3);
  offer_halton(evolution, 80, many_hills);
  double best = evolution.best().score;
  int calls = 0;
  const auto score = [&](const SearchPoint& p) {
    ++calls;
    EXPECT_TRUE(inside(p));
    return many_hills(p);
  };
  int asked = 0;
  for (int evaluations = 0; evaluations < 90; ++evaluations) {
    EXPECT_EQ(evolution.evolve(score, evaluations, {}, rng), StopReason::kBudget);
    asked += evaluations;
    ASSERT_EQ(calls, asked);
    ASSERT_GE(evolution.best().score, best);
    best = evolution.best().score;
  }
  for (const DeMember& member : evolution.population()) {
    EXPECT_TRUE(inside(member.point));
    EXPECT_EQ(member.score, many_hills(member.point));
    EXPECT_LE(member.score, best);
  }
}

TEST_P(EachStrategy, SameSeedSameBits) {
  const auto run = [&](std::uint64_t seed) {
    DifferentialEvolution evolution(params());
    Rng rng(seed);
    offer_halton(evolution, 80, many_hills);
    static_cast<void>(evolution.evolve(many_hills, 500, {}, rng));
    std::vector<SearchPoint> points;
    for (const DeMember& member : evolution.population()) {
      points.push_back(member.point);
    }
    return points;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

TEST_P(EachStrategy, BestSoFarIsValidAtADeadline) {
  struct Clock {
    mutable int asked = 0;
    int until = 0;
  };
  for (const int until : {0, 1, 5}) {
    const Clock clock{.until = until};
    const Deadline deadline(
        [](const void* c) { return static_cast<const Clock*>(c)->asked++ >= static_cast<const Clock*>(c)->until; },
        &clock);
    DifferentialEvolution evolution(params());
    Rng rng(4);
    offer_halton(evolution, 80, one_hill);
    const double before = evolution.best().score;
    int calls = 0;
    const auto score = [&](const SearchPoint& p) {
      ++calls;
      return one_hill(p);
    };
    EXPECT_EQ(evolution.evolve(score, 1000, deadline, rng), StopReason::kDeadline);
    EXPECT_EQ(calls, 16 * until) << "asked every 16 evaluations";
    EXPECT_GE(evolution.best().score, before);
    EXPECT_EQ(evolution.best().score, one_hill(evolution.best().point));
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachStrategy,
                         ::testing::Values(DeStrategy::kRand1Bin, DeStrategy::kBest1Bin, DeStrategy::kCurrentToBest1Bin,
                                           DeStrategy::kCurrentToRing1Bin, DeStrategy::kJde),
                         [](const auto& strategy) {
                           std::string name = kDeStrategyNames[static_cast<std::size_t>(strategy.param)];
                           std::erase(name, '-');
                           return name;
                         });

TEST(DifferentialEvolution, OffersReplaceTheWorst) {
  DifferentialEvolution evolution({.population = 8});
  evolution.begin(kBox);
  for (int i = 0; i < 20; ++i) {
    const int score = (i * 7) % 20;
    evolution.offer({static_cast<double>(score), 0.0, 0.0}, score);
  }
  std::vector<double> scores;
  for (const DeMember& member : evolution.population()) {
    scores.push_back(member.score);
  }
  std::sort(scores.begin(), scores.end());
  EXPECT_EQ(scores, (std::vector<double>{12, 13, 14, 15, 16, 17, 18, 19}));
  EXPECT_EQ(evolution.best().score, 19.0);
  evolution.begin(kBox);
  EXPECT_TRUE(evolution.population().empty());
}

}  // namespace
}  // namespace odoless
