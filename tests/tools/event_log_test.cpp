#include "tools/log/event_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/log_writer.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/raw_recording.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What the recorder writes.
std::string written(const std::vector<std::string>& texts) {
  const test::TemporaryFolder folder;
  LogWriterParams params;
  params.path = (folder.path() / "log").string();
  {
    LogWriter writer(params);
    for (const std::string& text : texts) {
      writer.record("CHANNEL", std::as_bytes(std::span(text.data(), text.size())), 5'000'000'000);
    }
  }
  return read_whole_file(folder.path() / "log.00000.lcm");
}

std::vector<std::string> read(const std::string& bytes) {
  EventLog log(view_bytes(bytes, "test.lcm"), "test.lcm");
  std::vector<std::string> texts;
  for (LoggedMessage message; log.next(message);) {
    EXPECT_EQ(message.channel, "CHANNEL");
    EXPECT_EQ(message.time_us, 5'000'000);
    texts.emplace_back(message.data.begin(), message.data.end());
  }
  return texts;
}

TEST(EventLog, ReadsWhatTheRecorderWrites) {
  EXPECT_THAT(read(written({"one", "two", std::string(200'000, 'x')})),
              ElementsAre("one", "two", std::string(200'000, 'x')));
  EXPECT_THAT(read(""), IsEmpty());
}

// Which planar_lidar_t does not tell.
TEST(EventLog, ScansOfTheRecorderHaveTheTimesOfTheirBeams) {
  const test::TemporaryFolder folder;
  LcmParams silent;
  silent.url = "";
  LogWriterParams params;
  params.path = (folder.path() / "log").string();
  {
    LogWriter writer(params);
    LcmLink link(silent, 1);
    link.set_tap(&writer);
    const std::vector<float> ranges_m(100, 2.0F);
    for (const std::int64_t beam_period_ns : {0, 25'000, 26'000}) {
      ASSERT_EQ(link.publish({.angle_step_rad = 0.01, .beams = 100, .beam_period_ns = beam_period_ns}, ranges_m),
                Errc::kOk);
    }
  }
  const ScanLog log = read_scan_log(folder.path() / "log.00000.lcm", {.topic = "ODOLESS_SCAN"});
  ASSERT_EQ(log.scans.size(), 3U);
  EXPECT_EQ(log.scans[0].beam_period_ns, 0);
  EXPECT_EQ(log.scans[1].beam_period_ns, 25'000);
  EXPECT_EQ(log.scans[2].beam_period_ns, 26'000);
}

TEST(EventLog, ACutLogEndsBeforeItsLastMessage) {
  const std::string whole = written({"one", "two"});
  for (std::size_t size = 1; size < whole.size(); ++size) {
    ASSERT_EQ(read(whole.substr(0, size)).size(), size < whole.size() / 2 ? 0U : 1U) << size;
  }
}

TEST(EventLog, PassesOverWhatIsDamaged) {
  EXPECT_THAT(read(written({"one"}) + std::string(5000, '\0') + written({"two"})), ElementsAre("one", "two"));
}

TEST(EventLog, RefusesWhatIsNoLogOrClaimsTooMuch) {
  EXPECT_THROW(static_cast<void>(read(std::string(2 * EventLog::kSkippedBytesMax, '\0'))), DataError);
  for (const std::size_t at : {20U, 24U}) {  // length of the channel, of the data
    std::string log = written({"one"});
    log[at] = '\x7f';
    EXPECT_THROW(static_cast<void>(read(log)), DataError) << at;
    log[at] = '\xff';
    EXPECT_THROW(static_cast<void>(read(log)), DataError) << at;
  }
}

TEST(RawRecording, AFileWithoutAnEndIsNoLog) {
  try {
    static_cast<void>(read_raw_recording("/dev/zero"));
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/dev/zero: no message in 1048576 bytes"));
  }
  EXPECT_THROW(static_cast<void>(read_raw_recording("/nowhere")), NoInputError);
}

}  // namespace
}  // namespace odoless
