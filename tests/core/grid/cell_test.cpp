#include "core/grid/cell.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

TEST(Cell, KnowsUnknownFreeAndHit) {
  Cell cell;
  EXPECT_TRUE(cell.is_unknown());
  EXPECT_FALSE(cell.is_free());
  cell.pass(0);
  EXPECT_TRUE(cell.is_unknown());
  cell.pass(1);
  EXPECT_FALSE(cell.is_unknown());
  EXPECT_TRUE(cell.is_free());
  cell.hit();
  EXPECT_FALSE(cell.is_free());
  EXPECT_FALSE(Cell(0, 1).is_unknown());
  EXPECT_FALSE(Cell(0, 1).is_free());
  EXPECT_TRUE(Cell(65535, 0).is_free());
}

TEST(Cell, StopsBeamsAtTheRateOfHitsPerWay) {
  Cell cell;
  for (int i = 0; i < 10; ++i) {
    cell.pass(Cell::kParts);
  }
  cell.hit();
  cell.hit();
  EXPECT_FLOAT_EQ(cell.stops_per_cell(0.0F), 0.2F);
  EXPECT_FLOAT_EQ(cell.stops_per_cell(8.0F * Cell::kParts), 0.125F);
  EXPECT_FLOAT_EQ(Cell(0, 3).stops_per_cell(0.5F * Cell::kParts), 2.0F);
}

TEST(Cell, KeepsItsRateWhenACounterOverflows) {
  Cell passed;
  Cell stopped;
  for (int i = 0; i < 100'000; ++i) {
    passed.pass(45);
    stopped.pass(1);
    if (i % 5 == 0) {
      passed.hit();
    }
    stopped.hit();
  }
  EXPECT_NEAR(passed.stops_per_cell(0.0F), 32.0 / (5 * 45), 0.002);
  EXPECT_NEAR(stopped.stops_per_cell(0.0F), 32.0, 0.1);
}

TEST(Cell, NeverForgetsThatABeamStopped) {
  Cell cell;
  cell.hit();
  for (int i = 0; i < 100'000; ++i) {
    cell.pass(45);
  }
  EXPECT_FALSE(cell.is_free());
}

}  // namespace
}  // namespace odoless
