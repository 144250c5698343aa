#include "drivers/lrf/rplidar/packet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace odoless::rplidar {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

std::vector<std::byte> bytes_of(const Request& request) { return {request.bytes().begin(), request.bytes().end()}; }

TEST(RplidarRequest, HasThePublishedBytes) {
  EXPECT_EQ(bytes_of(Request(Command::kStop)), bytes_of({0xA5, 0x25}));
  EXPECT_EQ(bytes_of(Request(Command::kScan)), bytes_of({0xA5, 0x20}));
  EXPECT_EQ(bytes_of(Request(Command::kExpress, bytes_of({0, 0, 0, 0, 0}))),
            bytes_of({0xA5, 0x82, 0x05, 0, 0, 0, 0, 0, 0x22}));
  EXPECT_EQ(bytes_of(Request(Command::kMotorDuty, bytes_of({0x94, 0x02}))),
            bytes_of({0xA5, 0xF0, 0x02, 0x94, 0x02, 0xC1}));
}

TEST(RplidarDescriptor, IsReadAsPublished) {
  const std::optional<Descriptor> scan = descriptor_of(bytes_of({0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81}));
  ASSERT_TRUE(scan.has_value());
  EXPECT_EQ(scan->length_bytes, 5U);
  EXPECT_TRUE(scan->is_stream);
  EXPECT_EQ(scan->type, 0x81);
  const std::optional<Descriptor> health = descriptor_of(bytes_of({0xA5, 0x5A, 0x03, 0, 0, 0, 0x06}));
  ASSERT_TRUE(health.has_value());
  EXPECT_FALSE(health->is_stream);
  EXPECT_FALSE(descriptor_of(bytes_of({0xA5, 0x5B, 0x03, 0, 0, 0, 0x06})).has_value());
}

TEST(RplidarNode, IsReadAndItsBitsAreChecked) {
  // Start of a turn, 90 degrees, 2 m.
  const std::vector<std::byte> node = bytes_of({0x3D, 0x01, 0x2D, 0x40, 0x1F});
  const std::optional<Point> point = node_of(node);
  ASSERT_TRUE(point.has_value());
  EXPECT_DOUBLE_EQ(point->angle_deg, 90.0);
  EXPECT_DOUBLE_EQ(point->range_m, 2.0);
  EXPECT_TRUE(point->starts_turn);
  EXPECT_FALSE(node_of(bytes_of({0x3F, 0x01, 0x2D, 0x40, 0x1F})).has_value()) << "both marks";
  EXPECT_FALSE(node_of(bytes_of({0x3C, 0x01, 0x2D, 0x40, 0x1F})).has_value()) << "neither mark";
  EXPECT_FALSE(node_of(bytes_of({0x3D, 0x00, 0x2D, 0x40, 0x1F})).has_value()) << "no check bit";
  EXPECT_FALSE(node_of(bytes_of({0x3D, 0x01, 0xFF, 0x40, 0x1F})).has_value()) << "more than a turn";
}

}  // namespace
}  // namespace odoless::rplidar
