#include <gtest/gtest.h>

#include <ostream>
#include <set>
#include <string>

#include "core/slam/lslam.hpp"
#include "tests/core/slam/same_pose.hpp"
#include "tests/support/plain_particles.hpp"
#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

/// A grid that the room does not quite fit into, so that its border is met, and it follows the robot.
LslamParams small_filter() {
  LslamParams params;
  params.particles = 24;
  params.beams_used = 30;
  params.tempering = 0.5;
  params.path_records_max = 4096;
  params.grid = {.resolution_m = 0.1, .width_m = 6.4, .height_m = 3.2, .tiles_max = 8000};
  return params;
}

void expect_same_map(AncestryGrid::View view, PlainMap& plain, const GridGeometry& grid) {
  for (int row = grid.first_row - 20; row < grid.first_row + grid.rows + 20; ++row) {
    for (int column = grid.first_column - 20; column < grid.first_column + grid.columns + 20; ++column) {
      ASSERT_EQ(view.at({column, row}), plain.at({column, row})) << column << ", " << row;
    }
  }
}

void expect_same_path(const std::vector<StampedPose>& path, const std::vector<StampedPose>& expected) {
  ASSERT_EQ(path.size(), expected.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_EQ(path[i].stamp_ns, expected[i].stamp_ns);
    ASSERT_TRUE(same_pose(path[i].map_T_scan, expected[i].map_T_scan));
  }
}

/// Of a tracker that is a little off, and of whose speed something is carried on.
ErrorProcess uncertainty() {
  ErrorProcess error = ErrorProcess::independent({}, Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal());
  error.transition.topLeftCorner<3, 3>() *= 0.5;
  error.transition(0, 3) = 0.1;
  error.transition(3, 3) = 0.9;
  error.noise(3, 3) = 0.01;
  return error;
}

struct OracleCase {
  std::string name;
  LslamParams params;
  int resamplings_least;
  std::vector<int> wanted_particles{};  ///< by turns, each for 10 updates; none: all
  std::size_t numbers_least = 1;        ///< different numbers of particles

  friend void PrintTo(const OracleCase& oracle_case, std::ostream* out) { *out << oracle_case.name; }
};

class LslamOracle : public ::testing::TestWithParam<OracleCase> {};

TEST_P(LslamOracle, GivesTheBitsOfParticlesThatEachCopyTheirMap) {
  const LslamParams& params = GetParam().params;
  Lslam lslam(params, 7);
  PlainParticles plain(params, 7);
  SimulatedRoom room(3);
  int resamplings = 0;
  int moves = 0;
  std::set<int> numbers;
  for (int update = 0; update < 60; ++update) {
    room.step();
    if (!GetParam().wanted_particles.empty()) {
      const std::size_t turn = static_cast<std::size_t>(update) / 10;
      const int wanted = GetParam().wanted_particles[turn % GetParam().wanted_particles.size()];
      lslam.set_particles(wanted);
      plain.set_particles(wanted);
    }
    Motion motion = room.motion();
    motion.set_error(uncertainty());
    const GridGeometry before = lslam.geometry();
    const UpdateReport report = lslam.update(motion, room.scan());
    moves += lslam.geometry().first_column != before.first_column || lslam.geometry().first_row != before.first_row;
    plain.update(motion, room.scan());
    ASSERT_EQ(report.resampled, plain.resampled());
    ASSERT_EQ(report.refused_tiles, 0);
    resamplings += report.resampled ? 1 : 0;
    ASSERT_EQ(static_cast<std::size_t>(lslam.particles()), plain.particles().size());
    numbers.insert(lslam.particles());
    for (int i = 0; i < lslam.particles(); ++i) {
      const auto index = static_cast<std::size_t>(i);
      ASSERT_TRUE(same_pose(lslam.pose(i), plain.particles()[index].map_T_scan)) << update << ", particle " << i;
      ASSERT_EQ(lslam.weight(i), plain.weights()[index]) << update << ", particle " << i;
      ASSERT_NO_FATAL_FAILURE(expect_same_map(lslam.map(i), plain.particles()[index].map, lslam.geometry()))
          << update << ", particle " << i;
    }
  }
  std::vector<StampedPose> path;
  lslam.write_path(path);
  expect_same_path(path, plain.particles()[static_cast<std::size_t>(lslam.best())].path);
  EXPECT_GE(resamplings, GetParam().resamplings_least);
  EXPECT_GT(moves, 0) << "of the window";
  EXPECT_GE(numbers.size(), GetParam().numbers_least);
}

std::vector<OracleCase> oracle_cases() {
  OracleCase often{"ResamplesOften", small_filter(), 10};
  OracleCase always{"ResamplesAlways", small_filter(), 60};
  always.params.resample_below = 1.0;
  OracleCase rarely{"ResamplesRarely", small_filter(), 2};
  rarely.params.resample_below = 0.1;
  OracleCase one{"HasOneParticle", small_filter(), 1};
  one.params.particles = 1;
  OracleCase refined{"RefinesAndUsesBeamsWithoutReturn", small_filter(), 5};
  refined.params.refine_steps = 3;
  refined.params.weigh_no_return = true;
  refined.params.free_no_return_m = 2.0;
  OracleCase changing{"ChangesTheirNumber", small_filter(), 5, {24, 7, 1, 16}};
  OracleCase spread{"HasAsManyAsTheirSpreadNeeds", small_filter(), 10};
  spread.params.particles_min = 4;
  spread.params.spread_error = 0.4;
  spread.numbers_least = 4;
  OracleCase thin{"MapsAThirdOfTheBeamsByTurns", small_filter(), 5};
  thin.params.beams_mapped = 20;
  return {often, always, rarely, one, refined, changing, spread, thin};
}

INSTANTIATE_TEST_SUITE_P(All, LslamOracle, ::testing::ValuesIn(oracle_cases()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace odoless
