#include "core/slam/lslam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

LslamParams room_filter() {
  LslamParams params;
  params.particles = 40;
  params.path_records_max = 4096;
  params.grid = {.resolution_m = 0.05, .width_m = 10.0, .height_m = 10.0, .tiles_max = 20'000};
  return params;
}

std::vector<double> all_numbers(const Lslam& lslam) {
  std::vector<double> numbers;
  for (int i = 0; i < lslam.particles(); ++i) {
    numbers.insert(numbers.end(), {lslam.pose(i).x_m, lslam.pose(i).y_m, lslam.pose(i).yaw_rad, lslam.weight(i)});
  }
  return numbers;
}

TEST(Lslam, StaysOnTrackWhereTheIncrementsAloneDriftAway) {
  Lslam lslam(room_filter(), 1);
  SimulatedRoom room(4, 120);
  Pose2 dead_reckoned;
  double filter_error_m = 0.0;
  double drift_m = 0.0;
  constexpr int kUpdates = 250;
  for (int i = 0; i < kUpdates; ++i) {
    room.step();
    Motion motion = room.motion();
    motion.previous_T_current = motion.previous_T_current * Pose2{0.002, -0.001, 0.002};  // a match with a bias
    dead_reckoned = i == 0 ? Pose2{} : dead_reckoned * motion.previous_T_current;
    static_cast<void>(lslam.update(motion, room.scan()));
    filter_error_m += lslam.estimate().map_T_scan.distance_m(room.map_T_scan()) / kUpdates;
    drift_m = std::max(drift_m, dead_reckoned.distance_m(room.map_T_scan()));
  }
  EXPECT_LT(filter_error_m, 0.06);
  EXPECT_GT(drift_m, 5.0 * filter_error_m);
  EXPECT_LT(lslam.estimate().map_T_scan.distance_m(room.map_T_scan()), 0.1);
}

TEST(Lslam, GivesTheSameForTheSameSeedAndAnotherForAnother) {
  const auto run = [](std::uint64_t seed) {
    Lslam lslam(room_filter(), seed);
    SimulatedRoom room(4);
    for (int i = 0; i < 30; ++i) {
      room.step();
      static_cast<void>(lslam.update(room.motion(), room.scan()));
    }
    return all_numbers(lslam);
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

TEST(Lslam, TakesItsFirstScanFromWhereItWasReset) {
  Lslam lslam(room_filter(), 1);
  SimulatedRoom room(4);
  for (int i = 0; i < 10; ++i) {
    room.step();
    static_cast<void>(lslam.update(room.motion(), room.scan()));
  }
  const Pose2 start{1.0, -0.5, 0.7};
  lslam.reset(start);
  EXPECT_EQ(lslam.particles(), 1);
  EXPECT_EQ(lslam.tiles_used(), 0);
  room.step();
  const UpdateReport report = lslam.update(room.motion(), room.scan());
  EXPECT_TRUE(report.resampled);
  EXPECT_EQ(lslam.particles(), 40);
  for (int i = 0; i < lslam.particles(); ++i) {
    EXPECT_EQ(lslam.pose(i).x_m, start.x_m);
    EXPECT_EQ(lslam.pose(i).yaw_rad, start.yaw_rad);
    EXPECT_EQ(lslam.weight(i), 1.0 / 40);
  }
  std::vector<StampedPose> path;
  lslam.write_path(path);
  EXPECT_EQ(path.size(), 1U);
}

// As after minutes in which the robot was lost: the speed of before would throw particles as far as it led in these.
TEST(Lslam, PromisesNoTravelOnceItsSpeedIsForgotten) {
  const auto promised_m = [](bool forget) {
    Lslam lslam(room_filter(), 1);
    SimulatedRoom room(4);
    for (int i = 0; i < 10; ++i) {
      room.step();
      static_cast<void>(lslam.update(room.motion(), room.scan()));
    }
    if (forget) {
      lslam.forget_speed();
    }
    room.step();
    Motion motion = room.motion();
    motion = Motion::between(motion.from_stamp_ns, motion.from_stamp_ns + 100'000'000'000, motion.previous_T_current);
    return lslam.update(motion, room.scan()).lambda_m;
  };
  EXPECT_GT(promised_m(false), 5.0);
  EXPECT_EQ(promised_m(true), 0.0);
}

TEST(Lslam, HasWeightsOfSumOneAndNamesTheHeaviestBest) {
  LslamParams params = room_filter();
  params.resample_below = 0.0;
  Lslam lslam(params, 1);
  SimulatedRoom room(4);
  for (int i = 0; i < 20; ++i) {
    room.step();
    const UpdateReport report = lslam.update(room.motion(), room.scan());
    double sum = 0.0;
    for (int k = 0; k < lslam.particles(); ++k) {
      sum += lslam.weight(k);
      EXPECT_LE(lslam.weight(k), lslam.weight(lslam.best()));
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
    EXPECT_EQ(report.resampled, i == 0);
    EXPECT_LE(report.log_likelihood_per_beam, 0.0);
    if (i > 0) {
      EXPECT_NEAR(report.effective_particles, lslam.effective_particles(), 1e-9);
    }
  }
}

/// Fewer are a relief that is needed now, more have time.
TEST(Lslam, HasFewerParticlesAtOnceAndMoreWithTheNextResampling) {
  LslamParams params = room_filter();
  params.resample_below = 0.0;
  Lslam lslam(params, 1);
  SimulatedRoom room(4);
  const auto particles_after = [&](int wanted) {
    lslam.set_particles(wanted);
    room.step();
    static_cast<void>(lslam.update(room.motion(), room.scan()));
    return lslam.particles();
  };
  EXPECT_EQ(particles_after(30), 30);
  EXPECT_EQ(particles_after(9), 9);
  EXPECT_EQ(particles_after(40), 9) << "nothing asked for a resampling";
  EXPECT_EQ(particles_after(4), 4);
  double sum = 0.0;
  for (int i = 0; i < lslam.particles(); ++i) {
    sum += lslam.weight(i);
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

/// The best after a resampling is a copy of the heaviest before it: its path ends where the heaviest was.
TEST(Lslam, KeepsTheBestThroughAResampling) {
  LslamParams never = room_filter();
  never.resample_below = 0.0;
  LslamParams always = room_filter();
  always.resample_below = 1.0;
  Lslam weighs(never, 1);
  Lslam resamples(always, 1);
  SimulatedRoom room(4);
  for (int i = 0; i < 2; ++i) {  // the second update is the first that weighs; until then both are the same
    room.step();
    static_cast<void>(weighs.update(room.motion(), room.scan()));
    static_cast<void>(resamples.update(room.motion(), room.scan()));
  }
  EXPECT_EQ(resamples.pose(resamples.best()).x_m, weighs.pose(weighs.best()).x_m);
  std::vector<StampedPose> path;
  resamples.write_path(path);
  EXPECT_EQ(path.back().map_T_scan.x_m, weighs.pose(weighs.best()).x_m);
}

TEST(Lslam, MovesAndKeepsItsWeightsWhenAScanSaysNothing) {
  Lslam lslam(room_filter(), 1);
  SimulatedRoom room(4);
  room.step();
  static_cast<void>(lslam.update(room.motion(), room.scan()));
  ScanFrame blind(ScanParams{});
  const std::vector<float> nothing(60, 0.0F);
  ASSERT_EQ(blind.assign({.stamp_ns = 1, .start_angle_rad = 0.0, .angle_step_rad = 0.1, .ranges_m = nothing}),
            Errc::kOk);
  const UpdateReport report = lslam.update(Motion::between(0, 1, {0.5, 0.0, 0.0}), blind);
  EXPECT_EQ(report.beams_weighed, 0);
  EXPECT_NEAR(report.effective_particles, 40.0, 1e-9);
  EXPECT_NEAR(lslam.estimate().map_T_scan.x_m, 0.5, 0.05);
}

TEST(Lslam, EstimatesMeanAndCovarianceOfTheParticlesAcrossTheWrapOfYaw) {
  LslamParams params = room_filter();
  params.particles = 2000;
  params.motion.rotation_spread_rad = 0.3;
  params.motion.slip_probability = 0.0;
  Lslam lslam(params, 1);
  lslam.reset({1.0, 2.0, 3.141});
  ScanFrame blind(ScanParams{});
  const std::vector<float> nothing(8, 0.0F);
  ASSERT_EQ(blind.assign({.start_angle_rad = 0.0, .angle_step_rad = 0.1, .ranges_m = nothing}), Errc::kOk);
  static_cast<void>(lslam.update({}, blind));
  ErrorProcess uncertainty;
  uncertainty.noise(0, 0) = 0.2 * 0.2;
  Motion motion;
  motion.set_error(uncertainty);
  static_cast<void>(lslam.update(motion, blind));
  const PoseEstimate estimate = lslam.estimate();
  EXPECT_NEAR(std::abs(estimate.map_T_scan.yaw_rad), 3.141, 0.02);
  EXPECT_NEAR(estimate.map_T_scan.x_m, 1.0, 0.03);
  EXPECT_NEAR(std::sqrt(estimate.covariance(0, 0)), 0.2, 0.02);
  EXPECT_NEAR(std::sqrt(estimate.covariance(2, 2)), 0.1, 0.01);
  EXPECT_NEAR(std::sqrt(estimate.covariance(1, 1)), std::hypot(0.02 / 3.0, 0.2 * 0.1), 0.002);  // the error turns along
}

TEST(Lslam, DropsParticlesForRoomWhenThePoolIsFullAndStaysOnTrack) {
  LslamParams params = room_filter();
  params.grid.tiles_max = 1500;
  Lslam lslam(params, 1);
  SimulatedRoom room(4, 120);
  std::int64_t refused = 0;
  bool was_refused = false;
  for (int i = 0; i < 150; ++i) {
    room.step();
    const UpdateReport report = lslam.update(room.motion(), room.scan());
    EXPECT_TRUE(report.resampled || !was_refused);
    was_refused = report.refused_tiles > 0;
    refused += report.refused_tiles;
    EXPECT_LE(lslam.tiles_used(), params.grid.tiles_max);
    EXPECT_EQ(lslam.particles(), params.particles);
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(lslam.estimate().map_T_scan.distance_m(room.map_T_scan()), 0.1);
}

/// Expires when it has been asked so many times.
class AskedOften {
 public:
  explicit AskedOften(int times) : left_(times) {}
  [[nodiscard]] Deadline view() const {
    return {[](const void* self) { return --static_cast<const AskedOften*>(self)->left_ < 0; }, this};
  }

 private:
  mutable int left_;
};

TEST(Lslam, GivesUpAtTheDeadlineWhatItHasNotWeighedOrMapped) {
  const LslamParams params = room_filter();
  for (const int asked : {0, 1, 20, 38, 39, 45, 60}) {
    Lslam lslam(params, 1);
    SimulatedRoom room(4, 120);
    room.step();
    static_cast<void>(lslam.update(room.motion(), room.scan()));
    room.step();
    const AskedOften deadline(asked);
    const UpdateReport report = lslam.update(room.motion(), room.scan(), deadline.view());
    EXPECT_EQ(report.unweighed_particles, std::max(0, params.particles - 1 - asked));
    EXPECT_TRUE(report.resampled || asked >= params.particles - 1);
    EXPECT_EQ(report.thinly_mapped_particles, 1);
    EXPECT_LE(report.unmapped_particles, params.particles - 1);
    EXPECT_EQ(lslam.particles(), params.particles);
  }
}

/// Once around, everything is 3.02 m away: the ends of two beams lie in different cells.
ScanFrame circle() {
  const std::vector<float> ranges_m(360, 3.02F);
  ScanFrame scan(ScanParams{});
  EXPECT_EQ(scan.assign({.angle_step_rad = std::numbers::pi / 180.0, .ranges_m = ranges_m}), Errc::kOk);
  return scan;
}

TEST(Lslam, MapsAnEvenChoiceOfTheBeamsThatAreLeftAtTheDeadline) {
  LslamParams params = room_filter();
  params.particles = 1;
  params.beams_mapped = 360;
  const ScanFrame scan = circle();
  for (const int asked : {0, 1, 3, 5, 6}) {
    Lslam lslam(params, 1);
    const AskedOften deadline(asked);
    const UpdateReport report = lslam.update({}, scan, deadline.view());
    EXPECT_EQ(report.thinly_mapped_particles, asked < 6 ? 1 : 0);
    AncestryGrid::View map = lslam.map(0);
    const auto is_mapped = [&](int beam) {
      const Point2 end = lslam.geometry().cells(scan.point(beam).x_m, scan.point(beam).y_m);
      return map.at({static_cast<int>(std::floor(end.x_m)), static_cast<int>(std::floor(end.y_m))}).hits() > 0;
    };
    int mapped = 0;
    int gap = 0;
    for (int beam = 0, missing = 0; beam < scan.size(); ++beam) {
      mapped += is_mapped(beam) ? 1 : 0;
      missing = is_mapped(beam) ? 0 : missing + 1;
      gap = std::max(gap, missing);
    }
    EXPECT_GE(mapped, std::min(360, 64 * asked + 32));
    EXPECT_LE(mapped, 64 * asked + 64 + 4) << "two ends in one cell";
    EXPECT_LT(gap, std::max(1, (360 - 64 * asked + 63) / 64));
  }
}

TEST(Lslam, StaysOnTrackWhereTheDeadlineEndsEveryOtherUpdate) {
  Lslam lslam(room_filter(), 1);
  SimulatedRoom room(4, 120);
  int unweighed = 0;
  int unmapped = 0;
  for (int i = 0; i < 150; ++i) {
    room.step();
    const AskedOften deadline(i % 2 == 0 ? 1000 : 10 + i % 50);
    const UpdateReport report = lslam.update(room.motion(), room.scan(), deadline.view());
    unweighed += report.unweighed_particles;
    unmapped += report.unmapped_particles;
  }
  EXPECT_GT(unweighed, 0);
  EXPECT_GT(unmapped, 0);
  EXPECT_LT(lslam.estimate().map_T_scan.distance_m(room.map_T_scan()), 0.1);
}

TEST(Lslam, WithADeadlineThatIsNotReachedGivesTheBitsOfNone) {
  const auto run = [](bool with_deadline) {
    Lslam lslam(room_filter(), 1);
    SimulatedRoom room(4);
    for (int i = 0; i < 20; ++i) {
      room.step();
      const AskedOften deadline(1000);
      static_cast<void>(lslam.update(room.motion(), room.scan(), with_deadline ? deadline.view() : Deadline{}));
    }
    return all_numbers(lslam);
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(Lslam, CountsWhatLiesOutsideOfItsGrid) {
  LslamParams params = room_filter();
  params.grid.width_m = params.grid.height_m = 3.2;
  Lslam lslam(params, 1);
  SimulatedRoom room(4);
  room.step();
  EXPECT_GT(lslam.update(room.motion(), room.scan()).outside_tiles, 0);
}

TEST(Lslam, MapsTheRoomsWallsAndItsInside) {
  Lslam lslam(room_filter(), 1);
  SimulatedRoom room(4, 300);
  for (int i = 0; i < 60; ++i) {
    room.step();
    static_cast<void>(lslam.update(room.motion(), room.scan()));
  }
  OccupancyMap map;
  lslam.write_occupancy(map);
  const auto occupancy_percent = [&](double x_m, double y_m) {
    return map.at(static_cast<int>((x_m - map.origin_x_m) / map.resolution_m),
                  static_cast<int>((y_m - map.origin_y_m) / map.resolution_m));
  };
  int wall_percent = 0;  // highest across the wall at x = 3 m, per height, summed up
  for (double y_m = -1.4; y_m < 0.0; y_m += 0.1) {
    wall_percent += std::max({occupancy_percent(2.93, y_m), occupancy_percent(2.98, y_m), occupancy_percent(3.03, y_m),
                              occupancy_percent(3.08, y_m)});
  }
  EXPECT_GT(wall_percent / 14, 40);
  EXPECT_LE(occupancy_percent(0.5, 0.5), 2);
  EXPECT_EQ(occupancy_percent(3.4, 0.0), OccupancyMap::kUnknown);
}

}  // namespace
}  // namespace odoless
