#include "drivers/lrf/rplidar/point_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "drivers/lrf/rplidar/bytes.hpp"
#include "drivers/lrf/rplidar/capsule.hpp"

namespace odoless::rplidar {
namespace {

struct Told {
  double range_mm = 0.0;
  double angle_deg = 0.0;
};

void append_node(std::vector<std::byte>& bytes, const Told& told) {
  const auto angle = static_cast<unsigned>(told.angle_deg * 64.0) << 1U | 1U;
  const auto range = static_cast<unsigned>(told.range_mm * 4.0);
  for (const unsigned value : {2U, angle, angle >> 8U, range, range >> 8U}) {
    bytes.push_back(static_cast<std::byte>(value & 0xFFU));
  }
}

/// Whether a standard scan with these points is taken whole.
void expect_taken(const std::vector<Told>& scan) {
  std::vector<std::byte> bytes;
  for (const Told& told : scan) {
    append_node(bytes, told);
  }
  PointReader reader;
  std::span<const std::byte> rest(bytes);
  std::size_t points = 0;
  PointReader::Outcome outcome = reader.take(rest);
  for (; outcome == PointReader::Outcome::kPoints; outcome = reader.take(rest)) {
    points += reader.points().size();
  }
  EXPECT_EQ(outcome, PointReader::Outcome::kMore) << "after point " << points;
  EXPECT_EQ(points, scan.size());
}

// What owners of an A1 published of theirs (ev3dev-lang-java, issue 85; Adafruit_CircuitPython_RPLIDAR, issue 29):
// points that nothing answered have the mirror's angle, others are
// compensated, and so angles step back and forth.
TEST(RplidarPointReader, TakesWhatRealDevicesSend) {
  expect_taken({{231, 21},  {234, 22},  {250, 22},  {0, 26},    {0, 27},    {0, 28},    {0, 29},    {0, 30},
                {0, 32},    {0, 33},    {0, 34},    {4318, 27}, {4330, 28}, {4376, 29}, {0, 38},    {0, 39},
                {0, 40},    {0, 41},    {0, 42},    {0, 43},    {0, 44},    {0, 45},    {0, 46},    {3287, 39},
                {3227, 40}, {3161, 41}, {3098, 42}, {3054, 43}, {2978, 44}, {2920, 45}, {2867, 46}, {2817, 47},
                {2767, 48}, {2735, 49}, {2689, 50}, {2644, 51}, {2602, 52}, {1238, 54}, {1244, 55}, {1186, 56},
                {1205, 57}, {1228, 58}, {1202, 59}, {1182, 60}, {1151, 61}, {1148, 62}, {1172, 63}, {1120, 64},
                {1135, 65}, {1192, 66}, {1233, 67}, {337, 71},  {0, 76},    {301, 73},  {305, 74},  {306, 75},
                {306, 76},  {308, 77},  {0, 82},    {318, 79},  {324, 80},  {251, 82},  {246, 83},  {247, 84},
                {254, 85},  {0, 90},    {0, 91},    {331, 87},  {331, 88}});
  expect_taken({{765, 208}, {705, 209}, {292, 213}, {289, 213}, {868, 212}, {0, 220}, {0, 221}, {0, 222}});
  expect_taken({{181, 351},
                {180, 353},
                {179, 353},
                {179, 357},
                {181, 355},
                {182, 359},
                {181, 0},
                {182, 1},
                {182, 0},
                {183, 1},
                {184, 4},
                {185, 4},
                {185, 4},
                {186, 5}});
  expect_taken({{0, 177.94},
                {0, 179.08},
                {0, 174.97},
                {0, 181.34},
                {0, 182.48},
                {0, 179.45},
                {404.5, 180.34},
                {405.5, 181.5},
                {407, 182.7},
                {0, 188.17},
                {0, 189.31},
                {412.25, 186.23}});
  expect_taken({{0, 133},
                {0, 134},
                {399, 130},
                {403, 131},
                {412, 132},
                {430, 133},
                {0, 140},
                {0, 141},
                {0, 142},
                {965, 136},
                {949, 137},
                {932, 138}});
}

TEST(RplidarPointReader, FarPointsMustGoOnFromOneToTheNext) {
  for (const double wrong_deg : {96.0, 116.0}) {
    std::vector<std::byte> bytes;
    for (int i = 0; i < 10; ++i) {
      append_node(bytes, {3000, i == 8 ? wrong_deg : 93.0 + i});
    }
    PointReader reader;
    std::span<const std::byte> rest(bytes);
    for (int i = 0; i < 8; ++i) {
      EXPECT_EQ(reader.take(rest), PointReader::Outcome::kPoints);
    }
    EXPECT_EQ(reader.take(rest), PointReader::Outcome::kSkipped) << wrong_deg;
  }
}

/// A capsule of the express scan with 32 ranges of 2 m.
std::vector<std::byte> capsule_of_2_m(double angle_deg) {
  const CapsuleFormat& format = *find_capsule_format(kExpressType);
  constexpr std::array kCabin{std::byte{0x40}, std::byte{0x1F}, std::byte{0x40}, std::byte{0x1F}, std::byte{0}};
  const auto angle = static_cast<unsigned>(angle_deg * 64.0);
  std::vector<std::byte> bytes{std::byte{}, std::byte{}, static_cast<std::byte>(angle & 0xFFU),
                               static_cast<std::byte>(angle >> 8U)};
  while (bytes.size() < format.bytes) {
    bytes.insert(bytes.end(), kCabin.begin(), kCabin.end());
  }
  const unsigned sum = xor_of(std::span(bytes).subspan(2));
  bytes[0] = static_cast<std::byte>(0xA0U | (sum & 0x0FU));
  bytes[1] = static_cast<std::byte>(0x50U | (sum >> 4U));
  return bytes;
}

/// How many points of 2 m are read of a stream of six capsules, the third of which `change` changes; another range is
/// a failure.
std::size_t points_of_2_m(void (*change)(std::vector<std::byte>&)) {
  std::vector<std::byte> stream;
  for (int i = 0; i < 6; ++i) {
    std::vector<std::byte> capsule = capsule_of_2_m(10.0 + 16.0 * i);
    if (i == 2) {
      change(capsule);
    }
    stream.insert(stream.end(), capsule.begin(), capsule.end());
  }
  PointReader reader;
  reader.start(find_capsule_format(kExpressType));
  std::span<const std::byte> rest(stream);
  std::size_t points = 0;
  for (auto outcome = reader.take(rest); outcome != PointReader::Outcome::kMore; outcome = reader.take(rest)) {
    if (outcome == PointReader::Outcome::kPoints) {
      for (const Point& point : reader.points()) {
        EXPECT_DOUBLE_EQ(point.range_m, 2.0);
      }
      points += reader.points().size();
    }
  }
  return points;
}

TEST(RplidarPointReader, GivesThePointsOfEveryCapsuleThatHasANext) {
  EXPECT_EQ(points_of_2_m([](std::vector<std::byte>&) {}), 5U * 32U);
}

// It takes the place of the last byte, which is the same, and so the sum is right; behind it, all ranges are others.
TEST(RplidarPointReader, ACapsuleWithAByteTooMuchThatItsSumDoesNotSeeIsNotTaken) {
  EXPECT_EQ(points_of_2_m([](std::vector<std::byte>& capsule) { capsule.insert(capsule.begin() + 40, std::byte{0}); }),
            4U * 32U);
}

TEST(RplidarPointReader, ACapsuleWithAWrongSumIsNotTaken) {
  EXPECT_EQ(points_of_2_m([](std::vector<std::byte>& capsule) { capsule[40] ^= std::byte{0x10}; }), 4U * 32U);
}

}  // namespace
}  // namespace odoless::rplidar
