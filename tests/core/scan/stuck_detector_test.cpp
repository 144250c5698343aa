#include "core/scan/stuck_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr int kSweepBeams = 181;

class StuckDetectorTest : public ::testing::Test {
 protected:
  /// A wall at that distance, as a laser with this noise sees it, rounded to this.
  std::vector<float> scan(double distance_m, double noise_sd_m, double quantum_m = 0.0) {
    std::vector<float> ranges_m;
    for (int i = 0; i < kSweepBeams; ++i) {
      const double range_m = distance_m + 0.01 * i + noise_sd_m * rng_.normal();
      ranges_m.push_back(static_cast<float>(quantum_m > 0.0 ? quantum_m * std::round(range_m / quantum_m) : range_m));
    }
    return ranges_m;
  }

  Rng rng_{1};
  StuckDetector detector_{kSweepBeams};
};

TEST_F(StuckDetectorTest, ALiveLaserAtRestIsNotStuckAlsoIfItRoundsToCentimetres) {
  for (int i = 0; i < 200; ++i) {
    detector_.add(scan(3.0, 0.008, 0.01));
    ASSERT_FALSE(detector_.is_suspect()) << i;
  }
}

TEST_F(StuckDetectorTest, AScanThatComesAgainButForAFewBeamsRepeats) {
  const std::vector<float> first = scan(3.0, 0.01);
  detector_.add(first);
  std::vector<float> again = first;
  for (std::size_t i = 0; i < again.size(); i += 12) {
    again[i] += 0.5F;
  }
  detector_.add(again);
  EXPECT_TRUE(detector_.repeats());
  detector_.add(scan(3.0, 0.01));
  EXPECT_FALSE(detector_.repeats());
}

TEST_F(StuckDetectorTest, ALaserOfMillimetresRepeatsAlsoWhereAThirdOfItsBeamsChange) {
  const std::vector<float> first = scan(3.0, 0.01, 0.001);
  detector_.add(first);
  detector_.add(scan(3.0, 0.01, 0.001));
  EXPECT_FALSE(detector_.repeats());
  std::vector<float> again = first;
  for (std::size_t i = 0; i < again.size(); i += 3) {
    again[i] += 0.5F;
  }
  detector_.add(first);
  detector_.add(again);
  EXPECT_TRUE(detector_.repeats());
}

TEST_F(StuckDetectorTest, AScanThatComesAgainWithLessThanTheLasersNoiseIsSuspect) {
  for (int i = 0; i < 10; ++i) {
    detector_.add(scan(3.0, 0.01));
    ASSERT_FALSE(detector_.is_suspect());
  }
  const std::vector<float> stuck = scan(3.0, 0.01);
  for (int i = 0; i < 10; ++i) {
    std::vector<float> noisy = stuck;
    for (float& range_m : noisy) {
      range_m += static_cast<float>(0.001 * rng_.normal());
    }
    detector_.add(noisy);
    EXPECT_FALSE(detector_.repeats());
    EXPECT_TRUE(i == 0 || detector_.is_suspect()) << i;
  }
}

TEST_F(StuckDetectorTest, ASceneThatComesToRestIsNoLongerSuspectAfterAWhile) {
  for (int i = 0; i < 50; ++i) {
    detector_.add(scan(3.0 + 0.1 * i, 0.01));
  }
  for (int i = 0; i < 100; ++i) {
    detector_.add(scan(8.0, 0.01));
  }
  EXPECT_FALSE(detector_.is_suspect());
}

// A robot that halts now and then, with a laser that is never stuck.
TEST_F(StuckDetectorTest, QuietScansThatTheSameSceneFollowsAreSuspectOnceOnly) {
  int suspects = 0;
  for (int halt = 0; halt < 20; ++halt) {
    for (int i = 0; i < 10; ++i) {
      detector_.add(scan(3.0 + 0.05 * (10 * halt + i), 0.01));
      EXPECT_FALSE(detector_.is_suspect()) << halt;
      EXPECT_FALSE(detector_.was_stuck()) << halt;
    }
    for (int i = 0; i < 5; ++i) {
      detector_.add(scan(3.45 + 0.5 * halt, 0.01));
      suspects += detector_.is_suspect() ? 1 : 0;
    }
  }
  EXPECT_GE(suspects, 1);
  EXPECT_LE(suspects, 5);
}

TEST_F(StuckDetectorTest, QuietScansThatAnotherSceneFollowsAreSuspectAgain) {
  for (int halt = 0; halt < 3; ++halt) {
    for (int i = 0; i < 10; ++i) {
      detector_.add(scan(3.0 + 5.0 * halt + 0.05 * i, 0.01));
      EXPECT_EQ(detector_.was_stuck(), halt > 0 && i == 0) << halt << ", " << i;
    }
    const std::vector<float> stuck = scan(3.45 + 5.0 * halt, 0.01);
    for (int i = 0; i < 10; ++i) {
      std::vector<float> noisy = stuck;
      for (float& range_m : noisy) {
        range_m += static_cast<float>(0.005 * rng_.normal());
      }
      detector_.add(noisy);
      EXPECT_TRUE(i == 0 || detector_.is_suspect()) << halt << ", " << i;
    }
  }
}

TEST_F(StuckDetectorTest, WithoutReturnsOrWithOtherBeamsItSaysNothing) {
  const std::vector<float> nothing(kSweepBeams, INFINITY);
  detector_.add(nothing);
  detector_.add(nothing);
  EXPECT_FALSE(detector_.is_suspect());
  detector_.add(std::vector<float>(30, 1.0F));
  detector_.add(std::vector<float>(31, 1.0F));
  EXPECT_FALSE(detector_.is_suspect());
  detector_.add(std::vector<float>(2 * kSweepBeams, 1.0F));  // more than there is room for
}

}  // namespace
}  // namespace odoless
