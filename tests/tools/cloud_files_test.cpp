#include "tools/output/cloud_files.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "core/base/rng.hpp"
#include "rt/cpu_clock.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"
#include "tools/output/cloud_picture.hpp"

namespace odoless {
namespace {

std::vector<Point3> random_points(std::size_t count) {
  Rng rng(1);
  std::vector<Point3> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({rng.uniform(-9.0, 9.0), rng.uniform(-7.0, 7.0), rng.uniform(0.0, 2.6)});
  }
  return points;
}

/// What follows the header's last line.
std::string body_after(const std::string& bytes, const std::string& last_line) {
  const std::size_t at = bytes.find(last_line);
  return at == std::string::npos ? std::string() : bytes.substr(at + last_line.size());
}

template <class Value>
Value value_at(const std::string& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

void expect_place(const std::string& body, std::size_t offset, const Point3& point) {
  EXPECT_EQ(value_at<float>(body, offset), static_cast<float>(point.x_m));
  EXPECT_EQ(value_at<float>(body, offset + 4), static_cast<float>(point.y_m));
  EXPECT_EQ(value_at<float>(body, offset + 8), static_cast<float>(point.z_m));
}

TEST(CloudFiles, PlyHoldsEveryPointAndItsColour) {
  const std::vector<Point3> points = random_points(1'000);
  const HeightColours colours(points);
  const std::string bytes = cloud_ply(points, colours);
  EXPECT_TRUE(bytes.starts_with("ply\nformat binary_little_endian 1.0\nelement vertex 1000\n"));
  const std::string body = body_after(bytes, "end_header\n");
  ASSERT_EQ(body.size(), 15'000U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    expect_place(body, 15 * i, points[i]);
    const Rgb colour{static_cast<std::uint8_t>(body[15 * i + 12]), static_cast<std::uint8_t>(body[15 * i + 13]),
                     static_cast<std::uint8_t>(body[15 * i + 14])};
    EXPECT_EQ(colour, colours.at(points[i].z_m));
  }
}

TEST(CloudFiles, PcdHoldsEveryPointAndItsColour) {
  const std::vector<Point3> points = random_points(1'000);
  const HeightColours colours(points);
  const std::string bytes = cloud_pcd(points, colours);
  EXPECT_NE(bytes.find("\nWIDTH 1000\nHEIGHT 1\n"), std::string::npos);
  const std::string body = body_after(bytes, "DATA binary\n");
  ASSERT_EQ(body.size(), 16'000U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    expect_place(body, 16 * i, points[i]);
    const Rgb colour = colours.at(points[i].z_m);
    EXPECT_EQ(value_at<std::uint32_t>(body, 16 * i + 12), colour.red * 65536U + colour.green * 256U + colour.blue);
  }
}

TEST(CloudFiles, PlyReadsBackOrIsRefused) {
  const test::TemporaryFolder folder;
  const std::vector<Point3> points = random_points(1'000);
  const std::string bytes = cloud_ply(points, HeightColours(points));
  const std::vector<Point3> back = read_cloud_ply(folder.file("cloud.ply", bytes));
  ASSERT_EQ(back.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(back[i].x_m, points[i].x_m, 1e-6);
    EXPECT_NEAR(back[i].y_m, points[i].y_m, 1e-6);
    EXPECT_NEAR(back[i].z_m, points[i].z_m, 1e-6);
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{100}, bytes.size() - 1}) {
    EXPECT_THROW(static_cast<void>(read_cloud_ply(folder.file("cut.ply", bytes.substr(0, size)))), DataError) << size;
  }
}

TEST(CloudFiles, EmptyCloudsAreFilesToo) {
  EXPECT_EQ(body_after(cloud_ply({}, HeightColours({})), "end_header\n"), "");
  EXPECT_NE(cloud_pcd({}, HeightColours({})).find("POINTS 0\n"), std::string::npos);
}

TEST(CloudFiles, ColoursGoFromBlueToRed) {
  const std::vector<Point3> points = random_points(10'000);
  const HeightColours colours(points);
  const Rgb low = colours.at(0.0);
  const Rgb high = colours.at(2.6);
  EXPECT_GT(low.blue, low.red);
  EXPECT_GT(high.red, high.blue);
  EXPECT_EQ(colours.at(-5.0), low);
  EXPECT_EQ(colours.at(50.0), high);
  EXPECT_GT(colours.at(1.3).green, 200);
}

// The bound is 5 s of a core, CPU time, so that others on the machine do not count; for both files together.
TEST(CloudFiles, TenMillionPointsAreWrittenInFiveSeconds) {
#if defined(__SANITIZE_ADDRESS__) || !defined(NDEBUG)
  GTEST_SKIP() << "time is measured in release builds without sanitizers";
#endif
  const test::TemporaryFolder folder;
  const std::vector<Point3> points = random_points(10'000'000);
  const std::int64_t start_ns = process_cpu_ns();
  const HeightColours colours(points);
  write_cloud_ply(folder.path() / "cloud.ply", points, colours);
  write_cloud_pcd(folder.path() / "cloud.pcd", points, colours);
  const double used_s = static_cast<double>(process_cpu_ns() - start_ns) * 1e-9;
  RecordProperty("cpu_s", std::to_string(used_s));
  EXPECT_LE(used_s, 5.0);
  EXPECT_GT(std::filesystem::file_size(folder.path() / "cloud.ply"), 150'000'000U);
  EXPECT_GT(std::filesystem::file_size(folder.path() / "cloud.pcd"), 160'000'000U);
}

int pixels_of(const Canvas& canvas, Rgb colour) {
  int found = 0;
  for (int row = 0; row < canvas.height_px(); ++row) {
    for (int column = 0; column < canvas.width_px(); ++column) {
      found += canvas.at({column, row}) == colour ? 1 : 0;
    }
  }
  return found;
}

// A low plate and a high one above half of it: from above the high one hides the low one.
TEST(CloudPicture, NearerPointsHideOthersAndTheCeilingIsCut) {
  std::vector<Point3> points;
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j < 400; ++j) {
      points.push_back({i * 0.025, j * 0.025, 0.0});
      points.push_back({i * 0.025, j * 0.025, j < 200 ? 1.0 : 0.0});
      points.push_back({i * 0.025, j * 0.025, 2.5});
    }
  }
  const HeightColours colours(points);
  const double cut_m = below_ceiling_m(colours);
  EXPECT_NEAR(cut_m, 2.2, 1e-9);
  const Canvas above = plan_of_cloud(points, colours, cut_m, 600).canvas;
  EXPECT_EQ(pixels_of(above, colours.at(2.5)), 0);
  const int low = pixels_of(above, colours.at(0.0));
  const int high = pixels_of(above, colours.at(1.0));
  EXPECT_GT(low, 1'000);
  EXPECT_NEAR(static_cast<double>(high) / low, 1.0, 0.15) << "half and half";
  const Canvas aside = draw_cloud_in_perspective(points, colours, cut_m);
  EXPECT_EQ(pixels_of(aside, colours.at(2.5)), 0);
  EXPECT_GT(pixels_of(aside, colours.at(0.0)), 1'000);
  EXPECT_GT(pixels_of(aside, colours.at(1.0)), 1'000);
}

TEST(CloudPicture, StaysSmallWhateverTheCloud) {
  for (const double size_m : {0.0, 1e-6, 1.0, 1e6}) {
    const std::vector<Point3> points{{0.0, 0.0, 0.0}, {size_m, size_m / 2.0, size_m}};
    const HeightColours colours(points);
    const Drawing above = draw_cloud_from_above(points, colours, 1e9);
    EXPECT_LE(above.width_px(), 2048);
    EXPECT_LE(above.height_px(), 2048);
    EXPECT_GT(pixels_of(draw_cloud_in_perspective(points, colours, 1e9), {255, 255, 255}), 0);
  }
  EXPECT_LE(draw_cloud_from_above({}, HeightColours({}), 0.0).width_px(), 2048);
}

}  // namespace
}  // namespace odoless
