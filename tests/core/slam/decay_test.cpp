#include "core/slam/decay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace odoless {
namespace {

TEST(Decay, IsTheExponentialOfMinusX) {
  EXPECT_FLOAT_EQ(decay(0.0F), 1.0F);
  for (float x = 0.0F; x < 80.0F; x += 0.00717F) {
    const double expected = std::exp(-static_cast<double>(x));
    EXPECT_NEAR(decay(x) / expected, 1.0, 4e-6 + 4e-7 * static_cast<double>(x)) << x;
  }
}

TEST(Decay, IsNothingFarOutAndForWhatIsNoNumber) {
  EXPECT_EQ(decay(80.0F), 0.0F);
  EXPECT_EQ(decay(std::numeric_limits<float>::infinity()), 0.0F);
  EXPECT_EQ(decay(std::numeric_limits<float>::quiet_NaN()), 0.0F);
}

TEST(Decay, NeverRisesByMoreThanRounding) {
  float before = decay(0.0F);
  for (float x = 0.0F; x < 10.0F; x += 0.0003F) {
    EXPECT_LE(decay(x), before * 1.000002F) << x;
    before = decay(x);
  }
}

}  // namespace
}  // namespace odoless
