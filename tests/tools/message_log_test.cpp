// Logs of messages: what the formats' own tools wrote, whole and damaged. tests/interop/logs_test.py has longer ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bot_core/raw_t.hpp>
#include <filesystem>
#include <limits>

#include "core/base/rng.hpp"
#include "tests/support/log_contract.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr float kBeyond = std::numeric_limits<float>::infinity();
constexpr const char* kCorpora[] = {"lcm_log", "ros_bag", "mcap", "sqlite_bag", "rawlog"};

std::vector<std::filesystem::path> files() {
  std::vector<std::filesystem::path> found;
  for (const char* const name : kCorpora) {
    const auto corpus =
        std::filesystem::path(__FILE__).parent_path().parent_path() / "fuzz" / (std::string(name) + "_corpus");
    for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
      found.push_back(entry.path());
    }
  }
  return found;
}

// tests/interop/make_corpus.py made them.
float true_range_m(int scan, int beam) {
  return beam == 7 ? kBeyond : 1.0F + 0.25F * static_cast<float>((7 * beam + 3 * scan) % 11);
}

TEST(MessageLog, FilesOfEachFormatsOwnToolsHaveTheSameScans) {
  ASSERT_EQ(files().size(), 9U);
  for (const std::filesystem::path& path : files()) {
    SCOPED_TRACE(path);
    const ScanLog log = read_scan_log(path);
    EXPECT_TRUE(log.has_stamps);
    EXPECT_TRUE(log.passed_over.empty());
    ASSERT_EQ(log.scans.size(), 5U);
    for (int k = 0; k < 5; ++k) {
      const LogScan& scan = log.scans[static_cast<std::size_t>(k)];
      EXPECT_EQ(scan.stamp_ns, 1'700'000'000'100'000'000 + k * 200'000'000);
      EXPECT_EQ(scan.start_angle_rad, -1.5);
      EXPECT_EQ(scan.angle_step_rad, 0.125);
      ASSERT_EQ(scan.ranges_m.size(), 25U);
      for (int i = 0; i < 25; ++i) {
        ASSERT_EQ(scan.ranges_m[static_cast<std::size_t>(i)], true_range_m(k, i)) << k << ", " << i;
      }
      EXPECT_GT(scan.no_return_m, 19.0F);
      const bool tells_beams = path.extension() != ".lcm" && path.extension() != ".rawlog";
      EXPECT_EQ(scan.beam_period_ns, tells_beams ? 976'563 : 0);
    }
  }
}

void damage(Rng& rng, std::string& bytes) {
  const auto place = [&] { return rng.below(static_cast<std::uint32_t>(bytes.size())); };
  switch (rng.below(4)) {
    case 0:
      bytes.resize(place());
      break;
    case 1:
      bytes.erase(place(), rng.below(64));
      break;
    case 2:
      bytes.replace(place(), 8, rng.below(2) == 0 ? std::string(8, '\0') : std::string(8, '\xff'));
      break;
    default:
      for (std::uint32_t i = 0; i <= rng.below(4); ++i) {
        bytes[place()] = static_cast<char>(rng.below(256));
      }
  }
}

TEST(MessageLog, DamagedFilesAreRefusedOrConsistent) {
  for (const std::filesystem::path& path : files()) {
    SCOPED_TRACE(path);
    const std::string whole = read_whole_file(path);
    int accepted = 0;
    constexpr int kRounds = 400;
    Rng rng(19);
    for (int round = 0; round < kRounds; ++round) {
      std::string bytes = whole;
      damage(rng, bytes);
      std::string broken;
      accepted += test::read_any_file(bytes, broken) ? 1 : 0;
      ASSERT_EQ(broken, "") << round;
    }
    EXPECT_LT(accepted, kRounds);
  }
}

// Found by rawlog_fuzz: a field of view so small that the step between beams is 0 once in single precision.
TEST(MessageLog, AnglesAreCheckedAsTheyAreKept) {
  const auto file = std::filesystem::path(__FILE__).parent_path().parent_path() / "fuzz/rawlog_corpus/mrpt.rawlog";
  std::string bytes = read_whole_file(file);
  const std::string scan_class = "CObservation2DRangeScan";
  const std::size_t field_of_view = bytes.find(scan_class) + scan_class.size() + 1;
  bytes.replace(field_of_view, 4, std::string("\1\0\0\0", 4));
  std::string broken;
  EXPECT_FALSE(test::read_any_file(bytes, broken));
  EXPECT_EQ(broken, "");
}

TEST(MessageLog, ACutFileIsRefusedOrItIsSaid) {
  for (const std::filesystem::path& path : files()) {
    SCOPED_TRACE(path);
    const std::string whole = read_whole_file(path);
    for (std::size_t size = 64; size < whole.size(); size += 1 + whole.size() / 300) {
      const test::TemporaryFile file(std::string_view(whole).substr(0, size));
      try {
        const ScanLog log = read_scan_log(file.path());
        // Between two messages a cut cannot be seen in an LCM log, nor in a rawlog, which MRPT packs, though.
        const bool is_a_row = path.extension() == ".lcm" || path.extension() == ".rawlog";
        EXPECT_TRUE(log.scans.size() == 5 || !log.passed_over.empty() || is_a_row) << size;
      } catch (const DataError& error) {
        EXPECT_THAT(error.what(), HasSubstr("; expected ")) << size;
      }
    }
  }
}

TEST(MessageLog, TopicsAreListedAndCanBeChosen) {
  for (const std::filesystem::path& path : files()) {
    SCOPED_TRACE(path);
    const std::vector<LogTopic> topics = read_topics(path);
    const auto with_scans = std::find_if(topics.begin(), topics.end(), [](const LogTopic& t) { return t.has_scans; });
    ASSERT_NE(with_scans, topics.end());
    EXPECT_EQ(with_scans->messages, 5);
    EXPECT_EQ(read_scan_log(path, {.topic = with_scans->name}).scans.size(), 5U);
    EXPECT_THROW(static_cast<void>(read_scan_log(path, {.topic = "elsewhere"})), DataError);
  }
  EXPECT_TRUE(read_topics(test::TemporaryFile("FLASER 1 2.0 0 0 0 0 0 0 1 a 1\n").path()).empty());
}

/// An event of an LCM log.
std::string event(const std::string& channel, const std::string& data) {
  const auto length = [](const std::string& text) {
    return std::string{'\0', '\0', '\0', static_cast<char>(text.size())};
  };
  return "\xed\xa1\xda\x01" + std::string(16, '\0') + length(channel) + length(data) + channel + data;
}

TEST(MessageLog, RawBytesAreNoScansAndItIsSaidWhatPlaysThem) {
  std::string fingerprint;
  for (int shift = 56; shift >= 0; shift -= 8) {
    fingerprint += static_cast<char>(bot_core::raw_t::getHash() >> shift);
  }
  const test::TemporaryFile file(event("ODOLESS_LRF_RAW_RX", fingerprint + std::string(20, '\0')));
  try {
    static_cast<void>(read_scan_log(file.path()));
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("has no scans"), HasSubstr("odoless emulate robot --from-raw")));
  }
}

TEST(MessageLog, SaysWhatItPassedOver) {
  const std::string whole = read_whole_file(files()[0]);
  const test::TemporaryFile file(whole + "garbage");
  const ScanLog log = read_scan_log(file.path());
  EXPECT_EQ(log.scans.size(), 5U);
  ASSERT_EQ(log.passed_over.size(), 1U);
  EXPECT_THAT(log.passed_over[0], HasSubstr("7 bytes"));
}

}  // namespace
}  // namespace odoless
