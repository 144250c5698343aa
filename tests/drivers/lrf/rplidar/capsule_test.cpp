#include "drivers/lrf/rplidar/capsule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "drivers/lrf/rplidar/bytes.hpp"

namespace odoless::rplidar {
namespace {

/// Bytes of a capsule that starts at 88 degrees.
std::vector<std::byte> capsule_of(const CapsuleFormat& format, const std::vector<unsigned>& cabins, bool is_first) {
  std::vector<std::byte> bytes(format.bytes);
  bytes[format.angle_at] = std::byte{0x00};
  bytes[format.angle_at + 1] = is_first ? std::byte{0x96} : std::byte{0x16};
  for (std::size_t i = 0; i < cabins.size(); ++i) {
    bytes[format.angle_at + 2 + i] = static_cast<std::byte>(cabins[i]);
  }
  const unsigned sum = xor_of(std::span(bytes).subspan(2));
  bytes[0] = static_cast<std::byte>(0xA0U | (sum & 0x0FU));
  bytes[1] = static_cast<std::byte>(0x50U | (sum >> 4U));
  return bytes;
}

std::array<Point, kCapsulePointsMax> points_of(int type, const std::vector<unsigned>& cabins,
                                               const std::vector<unsigned>& next_cabins = {}) {
  const CapsuleFormat& format = *find_capsule_format(type);
  const std::vector<std::byte> bytes = capsule_of(format, cabins, true);
  EXPECT_TRUE(is_capsule(format, bytes));
  EXPECT_TRUE(is_first_capsule(format, bytes));
  EXPECT_DOUBLE_EQ(capsule_angle_deg(format, bytes), 88.0);
  std::array<Point, kCapsulePointsMax> points;
  read_points(format, bytes, capsule_of(format, next_cabins, false), 0.5 * format.points, points);
  return points;
}

TEST(RplidarCapsule, AnExpressOneHasRangesAndCompensations) {
  // 4000 quarters of a millimetre and twice 63: bits 0 and 1 are of the compensation, whose other bits are all ones for
  // the first, and 4 eighths for the second, which has no range.
  const auto points = points_of(kExpressType, {0x43, 0x0F, 0x00, 0x00, 0x4F});
  EXPECT_DOUBLE_EQ(points[0].angle_deg, 88.0 - 7.875);
  EXPECT_DOUBLE_EQ(points[0].range_m, 0x0F40 / 4000.0);
  EXPECT_DOUBLE_EQ(points[1].angle_deg, 88.5 - 0.5);
  EXPECT_DOUBLE_EQ(points[31].angle_deg, 88.0 + 15.5);
}

TEST(RplidarCapsule, ADenseOneHasMillimetres) {
  const auto points = points_of(kDenseType, {0xE8, 0x03, 0x00, 0x00, 0xFF, 0xFF});
  EXPECT_DOUBLE_EQ(points[0].range_m, 1.0);
  EXPECT_DOUBLE_EQ(points[0].angle_deg, 88.0);
  EXPECT_DOUBLE_EQ(points[1].range_m, 0.0);
  EXPECT_DOUBLE_EQ(points[2].range_m, 65.535);
  EXPECT_DOUBLE_EQ(points[39].angle_deg, 88.0 + 19.5);
}

TEST(RplidarCapsule, AnUltraOneHasARangeOfEachThreeAndDifferences) {
  // 3000 mm are 2048 and 238 steps of 4, level 2; one step less; 10 steps more than the next, which is 3500 mm: 363.
  const unsigned first = (1280U + 238U) | (0x3FFU << 12U) | (10U << 22U);
  // No difference to the last, and none that is told.
  const unsigned second = (1280U + 363U) | (0U << 12U) | (511U << 22U);
  std::vector<unsigned> cabins;
  const unsigned third = (1280U + 363U) | (0x200U << 12U) | (0x200U << 22U);  // -512 is none, too
  for (const unsigned word : {first, second, third}) {
    for (const unsigned shift : {0U, 8U, 16U, 24U}) {
      cabins.push_back((word >> shift) & 0xFFU);
    }
  }
  const auto points = points_of(kUltraType, cabins);
  EXPECT_DOUBLE_EQ(points[0].range_m, 3.000);
  EXPECT_DOUBLE_EQ(points[1].range_m, 2.996);
  EXPECT_DOUBLE_EQ(points[2].range_m, 3.540);
  EXPECT_DOUBLE_EQ(points[3].range_m, 3.500);
  EXPECT_DOUBLE_EQ(points[4].range_m, 3.500);
  EXPECT_DOUBLE_EQ(points[5].range_m, 0.0);
  EXPECT_DOUBLE_EQ(points[7].range_m, 0.0);
  EXPECT_DOUBLE_EQ(points[8].range_m, 0.0);
  EXPECT_DOUBLE_EQ(points[0].angle_deg, 88.0 - compensation_deg(3.0));
  EXPECT_DOUBLE_EQ(points[5].angle_deg, 88.0 + 2.5) << "the mirror's, where nothing answered";
}

TEST(RplidarCapsule, AnUltraOnesLastRangeHangsOnTheNextOne) {
  std::vector<unsigned> cabins(128);
  cabins[127] = 0x01;  // 4 steps more than the next, the upper 10 bits of the word
  const auto points = points_of(kUltraType, cabins, {0x64, 0x00});
  EXPECT_DOUBLE_EQ(points[93].range_m, 0.0);
  EXPECT_DOUBLE_EQ(points[94].range_m, 0.1) << "of the next, where its own first has none";
  EXPECT_DOUBLE_EQ(points[95].range_m, 0.104);
}

TEST(RplidarCapsule, ScaledRangesGoOnFromScaleToScale) {
  int last_mm = -1;
  for (unsigned scaled = 0; scaled < 0x1000; ++scaled) {
    const ScaledRange range = ultra_range(scaled);
    ASSERT_GT(range.range_mm, last_mm);
    ASSERT_LE(range.range_mm - last_mm, 1 << range.level) << scaled;
    last_mm = range.range_mm;
  }
  EXPECT_EQ(last_mm, 16384 + 767 * 16);
}

TEST(RplidarCapsule, AnUltraDenseOneCountsFartherRangesMoreCoarsely) {
  // 500 steps of 2 mm; 100 of 3 mm beyond 2046; 100 of 4 mm beyond 8187; 8191 of 5 mm beyond 24567; each with quality
  // above it.
  const auto word = [](unsigned steps, unsigned bits, unsigned scale) {
    return 5U << (2 + bits) | steps << 2U | scale;
  };
  std::vector<unsigned> cabins;
  for (const auto& [one, other] :
       {std::pair{word(500, 10, 0), word(100, 11, 1)}, {word(100, 12, 2), word(8191, 13, 3)}}) {
    cabins.insert(cabins.end(), {one & 0xFFU, one >> 8U & 0xFFU, other & 0xFFU, other >> 8U & 0xFFU,
                                 (one >> 16U & 0x0FU) | (other >> 16U & 0x0FU) << 4U});
  }
  const auto points = points_of(kUltraDenseType, cabins);
  EXPECT_DOUBLE_EQ(points[0].range_m, 1.0);
  EXPECT_DOUBLE_EQ(points[1].range_m, 2.346);
  EXPECT_DOUBLE_EQ(points[2].range_m, 8.587);
  EXPECT_DOUBLE_EQ(points[3].range_m, 65.522);
  EXPECT_DOUBLE_EQ(points[4].range_m, 0.0);
  EXPECT_DOUBLE_EQ(points[63].angle_deg, 88.0 + 31.5);
}

// Slamtec's own figures, in 1/65536 rad: 8 degrees less k / 16 less k^3 / 98304 of k = 98361 / quarters of a mm.
TEST(RplidarCapsule, CompensationIsThatOfTheMakersModel) {
  for (const double range_m : {0.1, 0.3, 1.0, 5.0, 25.0}) {
    const double k = 98361.0 / (4000.0 * range_m);
    const double radians = 8.0 * std::numbers::pi / 180.0 - (64.0 * k + k * k * k / 98304.0) / 65536.0;
    EXPECT_NEAR(compensation_deg(range_m), radians * 180.0 / std::numbers::pi, 0.02) << range_m;
  }
}

TEST(RplidarCapsule, CompensationIsTheTriangle) {
  for (double range_m = 0.05; range_m < 30.0; range_m *= 1.01) {
    const double exact_deg = 8.0 - std::asin(0.024 / range_m) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(compensation_deg(range_m), exact_deg, 0.001) << range_m;
  }
}

TEST(RplidarCapsule, ItsSumSeesEveryChangeOfOneByte) {
  for (const CapsuleFormat& format : kCapsuleFormats) {
    const std::vector<std::byte> bytes = capsule_of(format, {0x43, 0x0F, 0x00, 0x00, 0x4F}, true);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (int change = 1; change < 256; ++change) {
        std::vector<std::byte> other = bytes;
        other[at] ^= static_cast<std::byte>(change);
        ASSERT_FALSE(is_capsule(format, other)) << "byte " << at << " changed by " << change;
      }
    }
  }
}

}  // namespace
}  // namespace odoless::rplidar
