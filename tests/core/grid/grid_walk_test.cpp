#include "core/grid/grid_walk.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

struct Visit {
  int column, row;
  float enter, exit;
};

std::vector<Visit> visits(const Point2& start, const Point2& direction, double length_cells) {
  std::vector<Visit> all;
  GridWalk walk(start, direction, length_cells);
  do {
    all.push_back({walk.cell().column(), walk.cell().row(), walk.enter(), walk.exit()});
  } while (walk.next() && all.size() < 100'000);
  return all;
}

/// Way of the beam within one cell, by clipping the beam to the square.
double clipped_cells(const Point2& start, const Point2& direction, double length_cells, int column, int row) {
  double from = 0.0;
  double to = length_cells;
  const auto clip = [&from, &to](double origin, double slope, double low) {
    if (slope == 0.0) {
      to = origin >= low && origin < low + 1.0 ? to : -1.0;
      return;
    }
    const double a = (low - origin) / slope;
    const double b = (low + 1.0 - origin) / slope;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  };
  clip(start.x_m, direction.x_m, column);
  clip(start.y_m, direction.y_m, row);
  return std::max(0.0, to - from);
}

TEST(GridWalk, GivesEachCellTheLengthThatClippingGives) {
  Rng rng(11);
  for (int i = 0; i < 2000; ++i) {
    const double angle_rad = i % 10 == 0 ? (i / 10 % 8) * std::numbers::pi / 4.0 : rng.uniform(-3.2, 3.2);
    const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
    const Point2 start{rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0)};
    const double length_cells = rng.uniform(0.0, 60.0);
    double sum = 0.0;
    float last_exit = 0.0F;
    for (const Visit& visit : visits(start, direction, length_cells)) {
      EXPECT_NEAR(visit.exit - visit.enter, clipped_cells(start, direction, length_cells, visit.column, visit.row),
                  2e-5);
      EXPECT_EQ(visit.enter, last_exit);
      last_exit = visit.exit;
      sum += static_cast<double>(visit.exit) - static_cast<double>(visit.enter);
    }
    EXPECT_NEAR(sum, length_cells, 1e-5);
  }
}

TEST(GridWalk, StepsToNeighboursAndEndsInTheCellOfTheEnd) {
  Rng rng(12);
  for (int i = 0; i < 2000; ++i) {
    const double angle_rad = rng.uniform(-3.2, 3.2);
    const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
    const Point2 start{rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0)};
    const double length_cells = rng.uniform(0.0, 60.0);
    const std::vector<Visit> all = visits(start, direction, length_cells);
    EXPECT_LE(static_cast<double>(all.size()), 2.0 * length_cells + 3.0);
    for (std::size_t k = 1; k < all.size(); ++k) {
      EXPECT_EQ(std::abs(all[k].column - all[k - 1].column) + std::abs(all[k].row - all[k - 1].row), 1);
    }
    EXPECT_NEAR(all.back().column + 0.5, start.x_m + length_cells * direction.x_m, 0.5 + 1e-6);
    EXPECT_NEAR(all.back().row + 0.5, start.y_m + length_cells * direction.y_m, 0.5 + 1e-6);
  }
}

TEST(GridWalk, RunsAlongAxesFromBordersWithoutLeavingItsRow) {
  for (const double sign : {1.0, -1.0}) {
    for (const Visit& visit : visits({3.0, 4.0}, {sign, 0.0}, 5.5)) {
      EXPECT_EQ(visit.row, 4);
    }
    for (const Visit& visit : visits({3.0, 4.0}, {0.0, sign}, 5.5)) {
      EXPECT_EQ(visit.column, 3);
    }
  }
}

TEST(GridWalk, StaysInOneCellWithoutLength) { EXPECT_EQ(visits({0.5, 0.5}, {1.0, 0.0}, 0.0).size(), 1U); }

TEST(GridWalk, SurvivesStartsFarOutside) {
  for (const double far : {1e300, -1e300, 1e12}) {
    EXPECT_LE(visits({far, -far}, {0.6, 0.8}, 10.0).size(), 23U);
  }
}

}  // namespace
}  // namespace odoless
