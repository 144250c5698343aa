#include "drivers/lrf/sort_nearly_sorted.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

/// Sorts with and without it, and counts how often two values are compared.
std::size_t comparisons(std::vector<double> values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::size_t count = 0;
  sort_nearly_sorted(std::span(values), [&](double a, double b) {
    ++count;
    return a < b;
  });
  EXPECT_EQ(values, sorted);
  return count;
}

TEST(SortNearlySorted, WhateverTheOrderItIsTheLibrarys) {
  Rng rng(11);
  for (const std::size_t size : {0U, 1U, 2U, 3U, 17U, 1000U}) {
    for (const double disorder : {0.0, 3.0, 30.0, 1e6}) {
      std::vector<double> values(size);
      for (std::size_t i = 0; i < size; ++i) {
        values[i] = std::floor(static_cast<double>(i) + disorder * rng.uniform());  // some are equal
      }
      static_cast<void>(comparisons(values));
    }
  }
}

TEST(SortNearlySorted, WhatIsNearlyInOrderTakesAComparisonOrTwoAndWhatIsNotBoundedTime) {
  constexpr std::size_t kSize = 8192;
  std::vector<double> rising(kSize);
  std::vector<double> falling(kSize);
  for (std::size_t i = 0; i < kSize; ++i) {
    rising[i] = static_cast<double>(i) + (i % 8 == 0 ? 1.5 : 0.0);
    falling[i] = -static_cast<double>(i);
  }
  EXPECT_LT(comparisons(rising), 2 * kSize);
  EXPECT_LT(comparisons(falling), 60 * kSize);
}

}  // namespace
}  // namespace odoless
