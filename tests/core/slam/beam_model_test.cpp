#include "core/slam/beam_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr double kResolution_m = 0.05;
constexpr int kSide_cells = 60;

class SmallMap {
 public:
  Cell& at(const GridCell& cell) { return at(cell.column(), cell.row()); }
  Cell& at(int column, int row) {
    const bool inside = column >= 0 && row >= 0 && column < kSide_cells && row < kSide_cells;
    return inside ? cells_[static_cast<std::size_t>(row * kSide_cells + column)] : outside_;
  }

 private:
  std::array<Cell, std::size_t{kSide_cells} * kSide_cells> cells_{};
  Cell outside_;
};

SmallMap random_map(Rng& rng) {
  SmallMap map;
  for (int row = 0; row < kSide_cells; ++row) {
    for (int column = 0; column < kSide_cells; ++column) {
      const std::uint32_t kind = rng.below(20);
      const auto way_parts = static_cast<std::uint16_t>(rng.below(3000));
      const auto hits = static_cast<std::uint16_t>(kind == 0 ? 1 + rng.below(30) : 0);
      map.at(column, row) = kind == 1 ? Cell() : Cell(way_parts, hits);
    }
  }
  return map;
}

/// The published formula, term by term, in metres and doubles: steps along the beam finer than any cell, cells found by
/// their coordinates and rates taken from rho = d / h.
double likelihood_by_formula(SmallMap& map, const BeamModelParams& params, const Point2& start_cells, double angle_rad,
                             double range_m) {
  constexpr double kStep_m = kResolution_m / 4000.0;
  const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
  const double end_m = range_m + 3.0 * params.sigma_m;
  double reach = 1.0;
  double sum = 0.0;
  for (double way_m = 0.0; way_m < end_m;) {
    const auto cell_at = [&](double at_m) {
      return GridCell(static_cast<int>(std::floor(start_cells.x_m + at_m / kResolution_m * direction.x_m)),
                      static_cast<int>(std::floor(start_cells.y_m + at_m / kResolution_m * direction.y_m)));
    };
    const GridCell cell = cell_at(way_m + 0.5 * kStep_m);
    double leave_m = way_m;
    while (leave_m < end_m && cell_at(leave_m + 0.5 * kStep_m).tile<0>() == cell.tile<0>()) {
      leave_m += kStep_m;
    }
    leave_m = std::min(leave_m, end_m);
    const Cell& seen = map.at(cell);
    const double way_in_cell_m = seen.way_parts() * kResolution_m / Cell::kParts;
    const double rho_m = seen.is_unknown() ? params.unknown_rho_m
                                           : std::max(way_in_cell_m / seen.hits(), params.rho_min_m);  // inf: free
    const double stops = 1.0 - std::exp(-(leave_m - way_m) / rho_m);
    const double sigmas = (range_m - 0.5 * (way_m + leave_m)) / params.sigma_m;
    if (seen.is_unknown() && params.unknown_likelihood > 0.0 && leave_m > range_m - 3.0 * params.sigma_m) {
      sum += reach * params.unknown_likelihood;
      break;
    }
    if (sigmas < 3.0) {
      sum += reach * stops * std::exp(-0.5 * sigmas * sigmas);
    }
    reach *= 1.0 - stops;
    way_m = leave_m;
  }
  return params.floor + (1.0 - params.floor) * sum;
}

void expect_the_formula(const BeamModelParams& params) {
  const BeamModel model(params, kResolution_m);
  Rng rng(4);
  for (int i = 0; i < 100; ++i) {
    SmallMap map = random_map(rng);
    const Point2 start{rng.uniform(20.0, 40.0), rng.uniform(20.0, 40.0)};
    const double angle_rad = rng.uniform(-3.1, 3.1);
    const double range_m = rng.uniform(0.02, 1.0);
    const double range_cells = range_m / kResolution_m;
    const GridWalk walk(start, {std::cos(angle_rad), std::sin(angle_rad)}, range_cells + model.reach_cells());
    const double expected = likelihood_by_formula(map, params, start, angle_rad, range_m);
    // 0.0025: what lies behind a wall that fewer beams pass is left out; a cell at the border of 3 sigma adds 0.011.
    EXPECT_NEAR(model.likelihood(map, walk, static_cast<float>(range_cells)), expected, 0.014) << i;
  }
}

TEST(BeamModel, GivesThePublishedLikelihood) {
  expect_the_formula(
      {.sigma_m = 0.08, .floor = 0.05, .unknown_rho_m = 1.0, .unknown_likelihood = 0.0, .rho_min_m = 0.02});
}

TEST(BeamModel, TakesABeamThatEndsInTheUnseenForUsual) {
  expect_the_formula(
      {.sigma_m = 0.08, .floor = 0.05, .unknown_rho_m = 1.0, .unknown_likelihood = 0.6, .rho_min_m = 0.02});
}

TEST(BeamModel, PrefersTheRangeAtWhichTheMapHasAWall) {
  const BeamModel model({}, kResolution_m);
  SmallMap map;
  for (int column = 0; column < 40; ++column) {
    map.at(column, 5) = Cell(2000, 0);
  }
  map.at(30, 5) = Cell(640, 40);
  const auto likelihood = [&](double range_cells) {
    const GridWalk walk({0.5, 5.5}, {1.0, 0.0}, range_cells + model.reach_cells());
    return model.likelihood(map, walk, static_cast<float>(range_cells));
  };
  EXPECT_GT(likelihood(30.0), 0.8);
  EXPECT_GT(likelihood(30.0), likelihood(28.5));
  EXPECT_GT(likelihood(28.5), likelihood(27.0));
  EXPECT_FLOAT_EQ(likelihood(15.0), 0.1F);  // the floor
}

TEST(BeamModel, TellsABeamThatPassesByWhatItPassed) {
  const BeamModelParams params{.sigma_m = 0.1, .floor = 0.1, .unknown_rho_m = 1.0, .rho_min_m = 0.02};
  const BeamModel model(params, kResolution_m);
  SmallMap map;
  const GridWalk walk({0.5, 5.5}, {1.0, 0.0}, 20.0);  // 1 m through unknown cells
  EXPECT_NEAR(model.likelihood_of_passing(map, walk), 0.1 + 0.9 * std::exp(-1.0), 1e-5);
  for (int column = 0; column < 40; ++column) {
    map.at(column, 5) = Cell(2000, 0);
  }
  EXPECT_FLOAT_EQ(model.likelihood_of_passing(map, walk), 1.0F);
}

TEST(BeamModel, AddsTheWayInEveryCellAndOneHitInTheLast) {
  const BeamModel model({}, kResolution_m);
  Rng rng(6);
  for (int i = 0; i < 200; ++i) {
    SmallMap map;
    const double angle_rad = rng.uniform(-3.1, 3.1);
    const double length_cells = rng.uniform(0.0, 25.0);
    const GridWalk walk({30.2, 30.7}, {std::cos(angle_rad), std::sin(angle_rad)}, length_cells);
    const bool stopped = i % 2 == 0;
    model.integrate(map, walk, stopped);
    std::uint32_t way_parts = 0;
    std::uint32_t hits = 0;
    for (int row = 0; row < kSide_cells; ++row) {
      for (int column = 0; column < kSide_cells; ++column) {
        way_parts += map.at(column, row).way_parts();
        hits += map.at(column, row).hits();
      }
    }
    EXPECT_EQ(way_parts, static_cast<std::uint32_t>(std::lround(length_cells * Cell::kParts)));
    EXPECT_EQ(hits, stopped ? 1U : 0U);
    const int end_column = static_cast<int>(std::floor(30.2 + length_cells * std::cos(angle_rad)));
    const int end_row = static_cast<int>(std::floor(30.7 + length_cells * std::sin(angle_rad)));
    EXPECT_EQ(map.at(end_column, end_row).hits(), hits);
  }
}

}  // namespace
}  // namespace odoless
