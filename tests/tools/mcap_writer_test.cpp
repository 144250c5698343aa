// tests/interop/logs_test.py has @mcap/core read what is written.
#include "tools/output/mcap_writer.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

#include "tests/support/log_contract.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/log/binary_cursor.hpp"
#include "tools/ros2/cdr.hpp"
#include "tools/ros2/definition.hpp"
#include "tools/ros2/messages.hpp"

namespace odoless {
namespace {

constexpr int kScans = 3000;  // several chunks
constexpr int kBeamsWritten = 200;
constexpr std::size_t kMagicBytes = 8;

std::int64_t stamp_ns(int k) { return 1'700'000'000'000'000'000 + std::int64_t{k} * 100'000'000; }

float range_m(int k, int i) { return 1.0F + 0.01F * static_cast<float>((17 * k + 5 * i) % 301); }

std::string scan_message(int k) {
  ros::LaserScan scan;
  scan.header.stamp = {static_cast<std::int32_t>(stamp_ns(k) / 1'000'000'000),
                       static_cast<std::uint32_t>(stamp_ns(k) % 1'000'000'000)};
  scan.header.frame_id = std::string(static_cast<std::size_t>(k % 5), 'x');  // moves all that is aligned
  scan.angle_min = -1.0F;
  scan.angle_increment = 0.0078125F;
  scan.range_max = 20.0F;
  for (int i = 0; i < kBeamsWritten; ++i) {
    scan.ranges.push_back(range_m(k, i));
  }
  return ros::CdrWriter().encode(scan);
}

class McapWritten : public ::testing::Test {
 protected:
  void SetUp() override {
    McapWriter file(path());
    const auto scans =
        file.add_channel("/scan", ros::type_name<ros::LaserScan>(), ros::Definition::of<ros::LaserScan>());
    const auto poses = file.add_channel("/path", ros::type_name<ros::Path>(), ros::Definition::of<ros::Path>());
    for (int k = 0; k < kScans; ++k) {
      file.write(scans, stamp_ns(k), scan_message(k));
      if (k % 100 == 0) {
        file.write(poses, stamp_ns(k), ros::CdrWriter().encode(ros::Path{}));
      }
    }
    file.finish();
    bytes_ = read_whole_file(path());
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "written.mcap"; }
  [[nodiscard]] std::string_view from(std::uint64_t place) const { return std::string_view(bytes_).substr(place); }

  test::TemporaryFolder folder_;
  std::string bytes_;
};

TEST_F(McapWritten, ReadsBackAsWhatWasWritten) {
  const ScanLog log = read_scan_log(path());
  ASSERT_EQ(log.scans.size(), static_cast<std::size_t>(kScans));
  for (int k = 0; k < kScans; ++k) {
    const LogScan& scan = log.scans[static_cast<std::size_t>(k)];
    ASSERT_EQ(scan.stamp_ns, stamp_ns(k));
    ASSERT_EQ(scan.start_angle_rad, -1.0);
    ASSERT_EQ(scan.angle_step_rad, 0.0078125);
    ASSERT_EQ(scan.ranges_m.size(), static_cast<std::size_t>(kBeamsWritten));
    for (int i = 0; i < kBeamsWritten; ++i) {
      ASSERT_EQ(scan.ranges_m[static_cast<std::size_t>(i)], range_m(k, i));
    }
  }
  const std::vector<LogTopic> topics = read_topics(path());
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[1].type, "nav_msgs/msg/Path");
  EXPECT_EQ(topics[1].messages, kScans / 100);
}

// The footer says where the summary begins, and its checksum is over all from there to itself.
TEST_F(McapWritten, TheSummaryIsWhereTheFooterSaysAndItsChecksumIsRight) {
  constexpr std::size_t kFooterBytes = 1 + 8 + 20;
  const std::size_t footer = bytes_.size() - kMagicBytes - kFooterBytes;
  BinaryCursor cursor(from(footer));
  EXPECT_EQ(cursor.number<std::uint8_t>(), 2);
  EXPECT_EQ(cursor.number<std::uint64_t>(), 20U);
  const auto summary = cursor.number<std::uint64_t>();
  const auto offsets = cursor.number<std::uint64_t>();
  const auto crc = cursor.number<std::uint32_t>();
  ASSERT_LT(summary, offsets);
  ASSERT_LT(offsets, footer);
  const std::string_view summed = from(summary).substr(0, bytes_.size() - kMagicBytes - 4 - summary);
  EXPECT_EQ(crc, crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size())));
  BinaryCursor group(from(offsets));
  EXPECT_EQ(group.number<std::uint8_t>(), 0x0E);
  EXPECT_EQ(group.number<std::uint64_t>(), 17U);
  EXPECT_EQ(group.number<std::uint8_t>(), 0x03);
  EXPECT_EQ(group.number<std::uint64_t>(), summary);
  EXPECT_EQ(bytes_.substr(bytes_.size() - kMagicBytes), bytes_.substr(0, kMagicBytes));
}

TEST_F(McapWritten, EveryChangedByteOfAChunkIsSeen) {
  const std::size_t chunk = bytes_.find("zstd") + 4 + 8;  // behind its size
  for (std::size_t at = chunk; at < chunk + 20'000; at += 997) {
    std::string damaged = bytes_;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    std::string broken;
    EXPECT_FALSE(test::read_any_file(damaged, broken)) << at;
    EXPECT_EQ(broken, "");
  }
}

TEST(McapWriter, LeavesNothingWithoutFinish) {
  const test::TemporaryFolder folder;
  {
    McapWriter file(folder.path() / "left.mcap");
    static_cast<void>(file.add_channel("/path", "nav_msgs/msg/Path", ""));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace odoless
