#include "tools/output/map_picture.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <limits>

#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

constexpr Rgb kRed{255, 0, 0};

OccupancyMap empty_map(int width_cells, int height_cells, double resolution_m) {
  OccupancyMap map{
      .resolution_m = resolution_m, .width_cells = width_cells, .height_cells = height_cells, .occupancy_percent = {}};
  map.occupancy_percent.assign(static_cast<std::size_t>(width_cells) * static_cast<std::size_t>(height_cells),
                               OccupancyMap::kUnknown);
  return map;
}

void set(OccupancyMap& map, int column, int row, int percent) {
  map.occupancy_percent[static_cast<std::size_t>(row * map.width_cells + column)] = static_cast<std::int8_t>(percent);
}

int count(const Canvas& canvas, Rgb colour) {
  int found = 0;
  for (int row = 0; row < canvas.height_px(); ++row) {
    for (int column = 0; column < canvas.width_px(); ++column) {
      found += canvas.at({column, row}) == colour ? 1 : 0;
    }
  }
  return found;
}

TEST(MapPicture, ShowsTheKnownPartAloneWithAMargin) {
  OccupancyMap map = empty_map(2000, 2000, 0.1);
  for (int column = 500; column < 1000; ++column) {
    set(map, column, 700, 100);
    set(map, column, 1099, 0);
  }
  const Canvas canvas = draw_map(map, {});
  EXPECT_EQ(canvas.width_px(), 520);
  EXPECT_EQ(canvas.height_px(), 420 + 40);
  EXPECT_EQ(canvas.at({9, 409}), (Rgb{205, 205, 205})) << "left of the wall";
  EXPECT_EQ(canvas.at({10, 409}), (Rgb{0, 0, 0})) << "the lowest row is at the bottom";
  EXPECT_EQ(canvas.at({509, 10}), (Rgb{255, 255, 255}));
}

TEST(MapPicture, DrawsPathsWhereTheyAre) {
  OccupancyMap map = empty_map(1000, 1000, 0.1);
  map.origin_x_m = -50.0;
  map.origin_y_m = -50.0;
  set(map, 100, 100, 50);
  set(map, 899, 899, 50);  // shows -41 .. 41 m
  const std::vector<ColouredPath> paths{{{{0, 0, 0}, {10, 0, 0}, {10, 5, 0}}, kRed}};
  const Canvas canvas = draw_map(map, paths);
  ASSERT_EQ(canvas.width_px(), 820);
  EXPECT_EQ(canvas.at({410 + 50, 409}), kRed);
  EXPECT_EQ(canvas.at({410 + 100, 409 - 25}), kRed);
  EXPECT_EQ(canvas.at({410, 409}), kRed) << "the disc at the start";
  EXPECT_EQ(canvas.at({410 + 50, 409 - 25}), (Rgb{205, 205, 205}));
}

TEST(MapPicture, SurvivesPathsFarOutside) {
  OccupancyMap map = empty_map(10, 10, 0.1);
  set(map, 5, 5, 100);
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ColouredPath> paths{{{{1e300, 0, 0}, {0.5, 0.5, 0}, {kNan, 0, 0}, {0.6, -1e9, 0}}, kRed},
                                        {{}, kRed}};
  EXPECT_GT(count(draw_map(map, paths), kRed), 0) << "the one pose that is on the picture";
}

TEST(MapPicture, ShowsAnUnknownMapAsSuch) {
  const Canvas canvas = draw_map(empty_map(1, 1, 0.05), {});
  EXPECT_EQ(canvas.at({canvas.width_px() / 2, 100}), (Rgb{205, 205, 205}));
}

TEST(MapPicture, ShrinksAHugeMapAndKeepsItsWalls) {
  OccupancyMap map = empty_map(20'000, 100, 0.05);
  set(map, 0, 50, 0);
  set(map, 19'999, 50, 0);
  set(map, 9'999, 50, 100);
  const Canvas canvas = draw_map(map, {});
  EXPECT_LE(canvas.width_px(), 4096);
  EXPECT_GT(canvas.width_px(), 2048);
  EXPECT_LE(canvas.height_px(), 4096);
  int black = 0;
  for (int row = 0; row < canvas.height_px() - 40; ++row) {
    for (int column = 0; column < canvas.width_px(); ++column) {
      black += canvas.at({column, row}) == Rgb{} ? 1 : 0;
    }
  }
  EXPECT_EQ(black, 1);
}

TEST(MapPicture, HasABarOfTheRightLength) {
  for (const auto& [side_cells, bar_px] : {std::pair{380, 10 * 20}, std::pair{180, 5 * 20 * 2}}) {
    OccupancyMap map = empty_map(side_cells, side_cells, side_cells == 380 ? 0.05 * 4 : 0.05);
    map.occupancy_percent.assign(map.occupancy_percent.size(), 0);
    const Canvas canvas = draw_map(map, {});
    int length_px = 0;
    for (int column = 0; column < canvas.width_px(); ++column) {
      length_px += canvas.at({column, canvas.height_px() - 12}) == Rgb{} ? 1 : 0;
    }
    const double width_m = side_cells * map.resolution_m + 2.0;
    const double bar_m = width_m >= 40.0 ? 10.0 : 5.0;
    EXPECT_NEAR(length_px, bar_m / width_m * canvas.width_px(), 1.0) << bar_px;
  }
}

TEST(MapPicture, IsAPngThatALibraryReads) {
  OccupancyMap map = empty_map(40, 40, 0.25);
  set(map, 10, 20, 100);
  set(map, 30, 20, 0);
  const std::vector<ColouredPath> paths{{{{2.5, 2.5, 0}, {7.5, 7.5, 0}}, kRed}};
  const test::TemporaryFolder folder;
  write_map_picture(folder.path() / "map.png", map, paths);
  const std::string bytes = test::content_of(folder.path() / "map.png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  image.format = PNG_FORMAT_RGB;
  std::vector<Rgb> pixels(static_cast<std::size_t>(image.width) * image.height);
  ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  const Canvas canvas = draw_map(map, paths);
  ASSERT_EQ(static_cast<int>(image.width), canvas.width_px());
  ASSERT_EQ(static_cast<int>(image.height), canvas.height_px());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int at = static_cast<int>(i);
    ASSERT_EQ(pixels[i], canvas.at({at % canvas.width_px(), at / canvas.width_px()}));
  }
}

}  // namespace
}  // namespace odoless
