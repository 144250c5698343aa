#include "tools/log/formats/laser_scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace odoless {
namespace {

using ::testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

/// What is written in the message, in its order.
struct Written {
  std::vector<float> ranges_m{1.0F, 2.0F};
  float time_increment_s = 0.001F;
  float range_min_m = 0.5F;
  float range_max_m = 10.0F;
  float step_rad = 0.5F;
  std::vector<float> intensities{};
};

class Message {
 public:
  explicit Message(std::endian order) : order_(order) {}

  void add(std::uint32_t number) {
    for (int i = 0; i < 4; ++i) {
      bytes_ += static_cast<char>(number >> (order_ == std::endian::little ? 8 * i : 24 - 8 * i));
    }
  }
  void add(float number) { add(std::bit_cast<std::uint32_t>(number)); }
  void add(const std::vector<float>& numbers) {
    add(static_cast<std::uint32_t>(numbers.size()));
    for (const float number : numbers) {
      add(number);
    }
  }
  void add(const std::string& letters) { bytes_ += letters; }

  void add(const Written& written) {
    add(-1.0F);
    add(1.0F);
    add(written.step_rad);
    add(written.time_increment_s);
    add(0.1F);
    add(written.range_min_m);
    add(written.range_max_m);
    add(written.ranges_m);
    add(written.intensities);
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::endian order_;
  std::string bytes_;
};

std::string ros1(const Written& written) {
  Message message(std::endian::little);
  message.add(7U);
  message.add(12U);
  message.add(345'678U);
  message.add(5U);
  message.add("laser");
  message.add(written);
  return message.bytes();
}

std::string cdr(const Written& written, int representation) {
  Message message(representation % 2 == 0 ? std::endian::big : std::endian::little);
  message.add(12U);
  message.add(345'678U);
  message.add(6U);
  message.add(std::string("laser\0\0\0", 8));
  message.add(written);
  return std::string{'\0', static_cast<char>(representation), '\0', '\0'} + message.bytes();
}

LogScan scan_of(const DecodedScan& decoded) {
  EXPECT_TRUE(std::holds_alternative<LogScan>(decoded)) << std::get<std::string>(decoded);
  return std::get<LogScan>(decoded);
}

void expect_refused(const std::string& message, RosEncoding encoding, const char* word) {
  const DecodedScan decoded = decode_laser_scan(message, encoding);
  ASSERT_TRUE(std::holds_alternative<std::string>(decoded));
  EXPECT_THAT(std::get<std::string>(decoded), HasSubstr(word));
}

TEST(LaserScan, SaysTheSameInEveryEncoding) {
  const std::vector<LogScan> scans{scan_of(decode_laser_scan(ros1({}), RosEncoding::kRos1)),
                                   scan_of(decode_laser_scan(cdr({}, 0), RosEncoding::kCdr)),
                                   scan_of(decode_laser_scan(cdr({}, 1), RosEncoding::kCdr)),
                                   scan_of(decode_laser_scan(cdr({}, 6), RosEncoding::kCdr)),
                                   scan_of(decode_laser_scan(cdr({}, 7), RosEncoding::kCdr))};
  for (const LogScan& scan : scans) {
    EXPECT_EQ(scan.stamp_ns, 12'000'345'678);
    EXPECT_EQ(scan.start_angle_rad, -1.0);
    EXPECT_EQ(scan.angle_step_rad, 0.5);
    EXPECT_EQ(scan.beam_period_ns, 1'000'000);
    EXPECT_EQ(scan.no_return_m, 10.0F);
    EXPECT_EQ(scan.ranges_m, (std::vector<float>{1.0F, 2.0F}));
  }
}

TEST(LaserScan, TellsNoReturnFromWhatIsNotKnown) {
  const LogScan scan = scan_of(
      decode_laser_scan(ros1({.ranges_m = {kNoNumber, kInfinity, -kInfinity, 0.4F, 0.5F, 10.0F}}), RosEncoding::kRos1));
  ScanFrame frame{ScanParams{}};
  ASSERT_EQ(frame.assign(scan.raw()), Errc::kOk);
  const std::vector<BeamState> expected{BeamState::kInvalid, BeamState::kNoReturn, BeamState::kInvalid,
                                        BeamState::kInvalid, BeamState::kReturn,   BeamState::kNoReturn};
  for (int i = 0; i < frame.size(); ++i) {
    EXPECT_EQ(frame.state(i), expected[static_cast<std::size_t>(i)]) << i;
  }
}

TEST(LaserScan, TimesAndLimitsThatTellNothingAreUnknown) {
  for (const float nothing : {0.0F, -1.0F, kNoNumber, kInfinity}) {
    const LogScan scan =
        scan_of(decode_laser_scan(ros1({.time_increment_s = nothing, .range_max_m = nothing}), RosEncoding::kRos1));
    EXPECT_EQ(scan.beam_period_ns, 0);
    EXPECT_EQ(scan.no_return_m, kInfinity);
  }
}

TEST(LaserScan, SkipsIntensities) {
  const LogScan scan = scan_of(decode_laser_scan(cdr({.intensities = {1.0F, 2.0F}}, 1), RosEncoding::kCdr));
  EXPECT_EQ(scan.ranges_m.size(), 2U);
}

TEST(LaserScan, RefusesEveryCutAndWhatGoesOn) {
  const std::string plain = ros1({});
  const std::string in_cdr = cdr({}, 1);
  for (std::size_t size = 0; size < plain.size(); ++size) {
    expect_refused(plain.substr(0, size), RosEncoding::kRos1, "shorter");
  }
  for (std::size_t size = 4; size < in_cdr.size(); ++size) {
    expect_refused(in_cdr.substr(0, size), RosEncoding::kCdr, "shorter");
  }
  expect_refused(in_cdr.substr(0, 3), RosEncoding::kCdr, "no CDR header");
  expect_refused(plain + "1", RosEncoding::kRos1, "goes on");
  expect_refused(in_cdr + "1234", RosEncoding::kCdr, "goes on");
}

TEST(LaserScan, RefusesCountsThatCannotBeAndOtherRepresentations) {
  std::string huge = ros1({});
  huge.replace(huge.size() - 16, 4, "\xff\xff\xff\xff");
  expect_refused(huge, RosEncoding::kRos1, "shorter");
  for (const int representation : {2, 3, 8, 9, 10}) {
    expect_refused(cdr({}, representation), RosEncoding::kCdr, "representation");
  }
}

}  // namespace
}  // namespace odoless
