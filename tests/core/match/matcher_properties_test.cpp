#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/core/match/match_support.hpp"

namespace odoless {
namespace {

// A sweep with its ranges at hand, so that one measurement can be told in several ways.
struct Measurement {
  SimulatedLaser laser;
  std::vector<float> ranges_m;

  [[nodiscard]] ScanFrame scan() const { return told(laser.start_angle_rad, laser.angle_step_rad, ranges_m); }
  [[nodiscard]] ScanFrame turned(double angle_rad) const {
    return told(laser.start_angle_rad + angle_rad, laser.angle_step_rad, ranges_m);
  }
  [[nodiscard]] ScanFrame reversed() const {
    const std::vector<float> backwards_m(ranges_m.rbegin(), ranges_m.rend());
    return told(laser.start_angle_rad + (laser.beams - 1) * laser.angle_step_rad, -laser.angle_step_rad, backwards_m);
  }
  [[nodiscard]] ScanFrame every_second() const {
    std::vector<float> half_m;
    for (std::size_t i = 0; i < ranges_m.size(); i += 2) {
      half_m.push_back(ranges_m[i]);
    }
    return told(laser.start_angle_rad, 2.0 * laser.angle_step_rad, half_m);
  }

 private:
  static ScanFrame told(double start_rad, double step_rad, const std::vector<float>& list_m) {
    ScanFrame scan(ScanParams{});
    EXPECT_EQ(scan.assign({.start_angle_rad = start_rad, .angle_step_rad = step_rad, .ranges_m = list_m}), Errc::kOk);
    return scan;
  }
};

class MatcherProperties : public ::testing::Test {
 protected:
  // Draws a new pair of measurements of the room.
  void draw() {
    const SimulatedScene room = cluttered_room();
    Pose2 map_T_reference;
    Pose2 map_T_scan;
    do {
      map_T_reference = random_free_pose(room, rng_);
      map_T_scan = random_free_pose(room, rng_);
      truth_ = map_T_reference.inverse() * map_T_scan;
    } while (std::hypot(truth_.x_m, truth_.y_m) > 1.5 || std::abs(truth_.yaw_rad) > 1.2);
    const SimulatedLaser laser{.beams = 541, .angle_step_rad = 1.5 * std::numbers::pi / 540};
    reference_ = {laser, ranges_m(room, laser, map_T_reference, rng_)};
    scan_ = {laser, ranges_m(room, laser, map_T_scan, rng_)};
    answer_ = bench_.match(reference_.scan(), scan_.scan()).reference_T_scan;
    ASSERT_TRUE(agree(answer_, truth_));
  }

  Rng rng_{1};
  MatchBench bench_;
  Measurement reference_;
  Measurement scan_;
  Pose2 truth_;
  Pose2 answer_;
};

TEST_F(MatcherProperties, MovingTheReferenceMovesTheAnswer) {
  for (int i = 0; i < 10; ++i) {
    draw();
    const Pose2 map_T_reference{rng_.uniform(-3.0, 3.0), rng_.uniform(-3.0, 3.0), rng_.uniform(-3.1, 3.1)};
    const MatchResult moved = bench_.match(reference_.scan(), scan_.scan(), map_T_reference, {map_T_reference});
    EXPECT_TRUE(agree(moved.reference_T_scan, map_T_reference * answer_)) << i;
  }
}

TEST_F(MatcherProperties, TurningBothScansTurnsTheAnswer) {
  for (int i = 0; i < 10; ++i) {
    draw();
    const double angle_rad = rng_.uniform(-3.0, 3.0);
    const Pose2 turn{0.0, 0.0, angle_rad};
    const MatchResult turned = bench_.match(reference_.turned(angle_rad), scan_.turned(angle_rad));
    EXPECT_TRUE(agree(turned.reference_T_scan, turn * answer_ * turn.inverse())) << i;
  }
}

TEST_F(MatcherProperties, OrderOfTheBeamsDoesNotMatter) {
  for (int i = 0; i < 10; ++i) {
    draw();
    EXPECT_TRUE(agree(bench_.match(reference_.reversed(), scan_.reversed()).reference_T_scan, answer_)) << i;
    EXPECT_TRUE(agree(bench_.match(reference_.scan(), scan_.reversed()).reference_T_scan, answer_)) << i;
  }
}

TEST_F(MatcherProperties, HalfTheBeamsGiveTheSameAnswer) {
  for (int i = 0; i < 10; ++i) {
    draw();
    EXPECT_TRUE(agree(bench_.match(reference_.scan(), scan_.every_second()).reference_T_scan, answer_)) << i;
    EXPECT_TRUE(agree(bench_.match(reference_.every_second(), scan_.every_second()).reference_T_scan, answer_)) << i;
  }
}

TEST_F(MatcherProperties, SwappingTheScansInvertsTheAnswer) {
  for (int i = 0; i < 10; ++i) {
    draw();
    EXPECT_TRUE(agree(bench_.match(scan_.scan(), reference_.scan()).reference_T_scan, answer_.inverse())) << i;
  }
}

}  // namespace
}  // namespace odoless
