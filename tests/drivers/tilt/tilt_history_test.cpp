#include "drivers/tilt/tilt_history.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

TEST(TiltHistory, InterpolatesOnTheLineBetweenNeighbours) {
  TiltHistory history(50 * kMs);
  EXPECT_TRUE(history.add(100 * kMs, 0.10));
  EXPECT_TRUE(history.add(110 * kMs, 0.30));
  EXPECT_TRUE(history.add(130 * kMs, -0.10));
  EXPECT_DOUBLE_EQ(history.angle_rad(100 * kMs).value(), 0.10);
  EXPECT_DOUBLE_EQ(history.angle_rad(105 * kMs).value(), 0.20);
  EXPECT_DOUBLE_EQ(history.angle_rad(110 * kMs).value(), 0.30);
  EXPECT_DOUBLE_EQ(history.angle_rad(120 * kMs).value(), 0.10);
  EXPECT_DOUBLE_EQ(history.angle_rad(130 * kMs).value(), -0.10);
}

TEST(TiltHistory, SaysWhyItCannotTell) {
  TiltHistory history(50 * kMs);
  EXPECT_EQ(history.angle_rad(0).error(), Errc::kNotYet);
  history.add(100 * kMs, 0.1);
  history.add(200 * kMs, 0.2);
  EXPECT_EQ(history.angle_rad(99 * kMs).error(), Errc::kTooOld);
  EXPECT_EQ(history.angle_rad(201 * kMs).error(), Errc::kNotYet);
  EXPECT_EQ(history.angle_rad(150 * kMs).error(), Errc::kGap);
  EXPECT_TRUE(history.angle_rad(100 * kMs).ok()) << "at a sample there is no gap";
  EXPECT_TRUE(history.angle_rad(200 * kMs).ok());
  history.clear();
  EXPECT_EQ(history.angle_rad(150 * kMs).error(), Errc::kNotYet);
}

TEST(TiltHistory, RefusesWhatIsNotLaterOrNoNumber) {
  TiltHistory history(50 * kMs);
  EXPECT_TRUE(history.add(100, 0.1));
  EXPECT_FALSE(history.add(100, 0.2));
  EXPECT_FALSE(history.add(99, 0.2));
  EXPECT_FALSE(history.add(101, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(history.add(101, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(history.size(), 1U);
}

// Oracle: a plain search from the front, over what must still be there.
TEST(TiltHistory, AgreesWithAPlainSearchAlsoAfterItsRingIsFull) {
  TiltHistory history(20 * kMs);
  std::vector<std::pair<std::int64_t, double>> all;
  Rng rng(3);
  std::int64_t stamp_ns = 0;
  for (int i = 0; i < 3000; ++i) {
    stamp_ns += 1 + rng.below(static_cast<std::uint32_t>(30 * kMs));
    all.emplace_back(stamp_ns, rng.uniform(-1.0, 1.0));
    ASSERT_TRUE(history.add(all.back().first, all.back().second));
    if (all.size() > TiltHistory::kSamples) {
      all.erase(all.begin());
    }
    const std::int64_t asked_ns = stamp_ns - rng.below(2'000'000'000U);
    const Result<double> told = history.angle_rad(asked_ns);
    if (asked_ns < all.front().first) {
      ASSERT_EQ(told.error(), Errc::kTooOld);
      continue;
    }
    std::size_t after = 0;
    while (all[after].first < asked_ns) {
      ++after;
    }
    if (all[after].first == asked_ns) {
      ASSERT_EQ(told.value(), all[after].second);
    } else if (all[after].first - all[after - 1].first > 20 * kMs) {
      ASSERT_EQ(told.error(), Errc::kGap);
    } else {
      const double share = static_cast<double>(asked_ns - all[after - 1].first) /
                           static_cast<double>(all[after].first - all[after - 1].first);
      ASSERT_NEAR(told.value(), std::lerp(all[after - 1].second, all[after].second, share), 1e-12);
    }
  }
}

}  // namespace
}  // namespace odoless
