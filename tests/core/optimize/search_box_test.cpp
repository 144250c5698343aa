#include "core/optimize/search_box.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

TEST(Halton, BeginsAsPublished) {
  const SearchPoint first = halton(0);
  EXPECT_DOUBLE_EQ(first[0], 1.0 / 2);
  EXPECT_DOUBLE_EQ(first[1], 1.0 / 3);
  EXPECT_DOUBLE_EQ(first[2], 1.0 / 5);
  const SearchPoint fifth = halton(4);
  EXPECT_DOUBLE_EQ(fifth[0], 5.0 / 8);
  EXPECT_DOUBLE_EQ(fifth[1], 7.0 / 9);
  EXPECT_DOUBLE_EQ(fifth[2], 1.0 / 25);
}

TEST(Halton, EveryRunOf360FillsEachOf360EqualBoxesOnce) {
  for (const int from : {0, 1, 77, 5000}) {
    std::set<std::tuple<int, int, int>> boxes;
    for (int i = from; i < from + 360; ++i) {
      const SearchPoint p = halton(i);
      const auto part = [](double fraction, int parts) {
        EXPECT_TRUE(fraction >= 0.0 && fraction < 1.0);
        return static_cast<int>(fraction * parts + 1e-9);
      };
      boxes.emplace(part(p[0], 8), part(p[1], 9), part(p[2], 5));
    }
    EXPECT_EQ(boxes.size(), 360U) << from;
  }
}

TEST(SearchBox, FractionsSpanTheBox) {
  const SearchBox box{{1.0, 2.0, 3.0}, {0.5, 1.0, 2.0}};
  EXPECT_EQ(box.at({0.0, 0.5, 1.0}), (SearchPoint{0.5, 2.0, 5.0}));
}

TEST(SearchBox, ReflectionKeepsInsideAndMirrorsOutside) {
  const SearchBox box{{1.0, 2.0, 3.0}, {0.5, 1.0, 2.0}};
  SearchPoint inside{0.6, 2.9, 1.1};
  const SearchPoint before = inside;
  box.reflect(inside);
  EXPECT_EQ(inside, before);
  SearchPoint outside{1.7, 0.9, 5.5};
  box.reflect(outside);
  EXPECT_NEAR(outside[0], 1.3, 1e-12);
  EXPECT_NEAR(outside[1], 1.1, 1e-12);
  EXPECT_NEAR(outside[2], 4.5, 1e-12);
}

TEST(SearchBox, HoldsWhatIsNoFartherThanItsWalls) {
  const SearchBox box{{1.0, 2.0, 3.0}, {0.5, 1.0, 2.0}};
  EXPECT_TRUE(box.holds({1.0, 2.0, 3.0}));
  EXPECT_TRUE(box.holds({0.5, 3.0, 5.0}));
  EXPECT_FALSE(box.holds({0.499, 2.0, 3.0}));
  EXPECT_FALSE(box.holds({1.0, 3.001, 3.0}));
  EXPECT_FALSE(box.holds({1.0, 2.0, 0.999}));
}

TEST(SearchBox, ReflectionBringsBackFromAnywhere) {
  const SearchBox box{{1.0, 2.0, 3.0}, {0.5, 1.0, 2.0}};
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const double far = std::exp(rng.uniform(-3.0, 20.0));
    SearchPoint p{far * rng.normal(), far * rng.normal(), far * rng.normal()};
    box.reflect(p);
    for (std::size_t k = 0; k < p.size(); ++k) {
      EXPECT_LE(std::abs(p[k] - box.centre[k]), box.half_size[k] + 1e-12);
    }
    EXPECT_TRUE(box.holds(p));
  }
}

}  // namespace
}  // namespace odoless
