#include "tools/output/map_picture.hpp"

#include <fmt/core.h>
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

/// Of the map's own picture.
Rgb at(const Canvas& canvas, int column_px, int row_px) {
  return canvas.at({kPlanLeft_px + column_px, kPlanTop_px + row_px});
}

TEST(MapPicture, ShowsTheKnownPartAloneWithAMargin) {
  OccupancyMap map = empty_map(2000, 2000, 0.1);
  for (int column = 500; column < 1000; ++column) {
    set(map, column, 700, 100);
    set(map, column, 1099, 0);
  }
  const Canvas canvas = draw_map(map, {}).pixels();
  EXPECT_EQ(canvas.width_px(), 520 + kPlanLeft_px + kPlanRight_px);
  EXPECT_EQ(canvas.height_px(), 420 + kPlanTop_px + kPlanBottom_px);
  EXPECT_EQ(at(canvas, 5, 405), (Rgb{205, 205, 205})) << "left of the wall";
  EXPECT_GT(at(canvas, 8, 409).red, 150);  // a grid line is over it
  EXPECT_LT(at(canvas, 13, 409).red, 30) << "the lowest row is at the bottom";
  EXPECT_GT(at(canvas, 505, 10).red, 225);
}

TEST(MapPicture, DrawsPathsWhereTheyAre) {
  OccupancyMap map = empty_map(1000, 1000, 0.1);
  map.origin_x_m = -50.0;
  map.origin_y_m = -50.0;
  set(map, 100, 100, 50);
  set(map, 899, 899, 50);  // shows -41 .. 41 m
  const std::vector<ColouredPath> paths{{{{0, 0, 0}, {10, 0, 0}, {10, 5, 0}}, kRed}};
  const Canvas canvas = draw_map(map, paths).pixels();
  ASSERT_EQ(canvas.width_px(), 820 + kPlanLeft_px + kPlanRight_px);
  EXPECT_EQ(at(canvas, 410 + 50, 409), kRed);
  EXPECT_EQ(at(canvas, 410 + 100, 409 - 25), kRed);
  EXPECT_EQ(at(canvas, 410, 409), kRed) << "the disc at the start";
  EXPECT_EQ(at(canvas, 410 + 53, 409 - 22), (Rgb{205, 205, 205}));
}

TEST(MapPicture, SurvivesPathsFarOutside) {
  OccupancyMap map = empty_map(10, 10, 0.1);
  set(map, 5, 5, 100);
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ColouredPath> paths{{{{1e300, 0, 0}, {0.5, 0.5, 0}, {kNan, 0, 0}, {0.6, -1e9, 0}}, kRed},
                                        {{}, kRed}};
  EXPECT_GT(count(draw_map(map, paths).pixels(), kRed), 0) << "the one pose that is on the picture";
}

TEST(MapPicture, ShowsAnUnknownMapAsSuch) {
  const Canvas canvas = draw_map(empty_map(1, 1, 0.05), {}).pixels();
  EXPECT_EQ(canvas.at({canvas.width_px() / 2, 100}), (Rgb{205, 205, 205}));
}

TEST(MapPicture, ShrinksAHugeMapAndKeepsItsWalls) {
  OccupancyMap map = empty_map(20'000, 100, 0.05);
  set(map, 0, 50, 0);
  set(map, 19'999, 50, 0);
  set(map, 9'999, 50, 100);
  const Canvas canvas = draw_map(map, {}).pixels();
  EXPECT_LE(canvas.width_px(), 4096);
  EXPECT_GT(canvas.width_px(), 2048);
  EXPECT_LE(canvas.height_px(), 4096);
  int black = 0;
  for (int row = 0; row < canvas.height_px() - kPlanTop_px - kPlanBottom_px; ++row) {
    const int column = (canvas.width_px() - kPlanLeft_px - kPlanRight_px) / 2;
    for (int near = column - 2; near <= column + 2; ++near) {
      black += at(canvas, near, row).red < 45 ? 1 : 0;
    }
  }
  EXPECT_EQ(black, 1);
}

TEST(MapPicture, HasABarOfTheRightLength) {
  for (const double width_m : {0.7, 9.0, 20.0, 50.0, 82.0, 999.0}) {
    const double bar_m = scale_bar_m(width_m);
    EXPECT_GE(bar_m, 0.1 * width_m);
    EXPECT_LE(bar_m, 0.25 * width_m * (1.0 + 1e-6));
  }
  EXPECT_DOUBLE_EQ(scale_bar_m(20.0), 5.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(82.0), 20.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(0.7), 0.1);
  const Plan plan{.picture = Canvas(400, 300, {200, 200, 200}), .px_per_m = 20.0};
  const Canvas canvas = draw_plan(plan).pixels();
  int length_px = 0;
  while (canvas.at({kPlanLeft_px + length_px, kPlanTop_px + 300 + 38}) == Rgb{}) {
    ++length_px;
  }
  EXPECT_EQ(length_px, 5 * 20);
}

// The numbers at the axes, as the picture as SVG has them, stand where the picture shows that place.
TEST(MapPicture, AxesAreWhereTheySay) {
  const Plan plan{.title = "a <title> & more",
                  .picture = Canvas(400, 300, {200, 200, 200}),
                  .low = {-7.5, 2.5},
                  .px_per_m = 20.0,
                  .paths = {{{{0, 5, 0}, {1, 6, 0}}, kRed, "path (final)"}}};
  const std::string svg = draw_plan(plan).svg();
  EXPECT_NE(svg.find(">-6</text>"), std::string::npos);
  EXPECT_NE(
      svg.find(fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"", kPlanLeft_px + 1.5 * 20.0, kPlanTop_px + 300 + 17.0)),
      std::string::npos)
      << svg.substr(svg.find("</svg>") - 3000);
  EXPECT_NE(svg.find("a &lt;title&gt; &amp; more"), std::string::npos);
  EXPECT_NE(svg.find(">path (final)</text>"), std::string::npos);
  EXPECT_NE(svg.find(">x in m</text>"), std::string::npos);
  EXPECT_NE(svg.find("#ff0000"), std::string::npos);
  EXPECT_EQ(svg, draw_plan(plan).svg());
}

TEST(Drawing, TextIsDrawnWhereItIsSaidAndOnlyThere) {
  Drawing drawing(200, 60, {255, 255, 255});
  drawing.text({100.0, 40.0}, "42 m\n\xc3\xa9", {.height_px = 14.0, .align = Align::kMiddle});
  const Canvas canvas = drawing.pixels();
  int inside = 0;
  int outside = 0;
  for (int row = 0; row < canvas.height_px(); ++row) {
    for (int column = 0; column < canvas.width_px(); ++column) {
      const bool is_near = row >= 24 && row <= 42 && column >= 60 && column <= 140;
      (is_near ? inside : outside) += canvas.at({column, row}).red < 128 ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 60);
  EXPECT_EQ(outside, 0);
}

TEST(MapPicture, IsAPngThatALibraryReads) {
  OccupancyMap map = empty_map(40, 40, 0.25);
  set(map, 10, 20, 100);
  set(map, 30, 20, 0);
  const std::vector<ColouredPath> paths{{{{2.5, 2.5, 0}, {7.5, 7.5, 0}}, kRed}};
  const test::TemporaryFolder folder;
  write_map_picture(folder.path() / "map.png", map, paths, "");
  const std::string bytes = test::content_of(folder.path() / "map.png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  image.format = PNG_FORMAT_RGB;
  std::vector<Rgb> pixels(static_cast<std::size_t>(image.width) * image.height);
  ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  const Canvas canvas = draw_map(map, paths).pixels();
  ASSERT_EQ(static_cast<int>(image.width), canvas.width_px());
  ASSERT_EQ(static_cast<int>(image.height), canvas.height_px());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int at = static_cast<int>(i);
    ASSERT_EQ(pixels[i], canvas.at({at % canvas.width_px(), at / canvas.width_px()}));
  }
}

}  // namespace
}  // namespace odoless
