#include "drivers/lrf/scip/time_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "drivers/lrf/scip/reply_reader.hpp"
#include "tests/support/times.hpp"
#include "tools/emulate/scip_text.hpp"

namespace odoless {
namespace {

using test::kMs;
using test::kSecond;

/// A device that shows 5000 ms at 100 s of the host's time, at the end of a line.
struct TimedLine {
  explicit TimedLine(int line_baud, std::int64_t thinking_ns = kMs, int times_told = 100)
      : baud(line_baud), thinks_ns(thinking_ns), answers_right(times_told) {}

  std::optional<ClockReading> asked() {
    const auto way_ns = [&](int bytes) { return baud == 0 ? 0 : bytes * 10 * kSecond / baud; };
    scip::TimeQuery query;
    std::int64_t now_ns = 100 * kSecond + 300'000;
    for (query.start(baud); !query.done() && requests.size() < 100;) {
      const std::string request(query.request(now_ns));
      requests.push_back(request);
      now_ns += way_ns(4);
      const std::int64_t device_ms = 5000 + (now_ns - 100 * kSecond) / kMs;
      now_ns += thinks_ns;
      std::string reply = scip::answer(request.substr(0, 3), "00");
      if (request == "TM1\n" && answers_right-- > 0) {
        reply =
            "TM1\n" + scip::summed("00") + scip::summed(scip::encoded(static_cast<std::uint32_t>(device_ms), 4)) + "\n";
        now_ns += way_ns(14);
      }
      scip::ReplyReader reader(200, 10);
      std::string_view rest = reply;
      EXPECT_EQ(reader.take(rest), scip::ReplyReader::Outcome::kReply);
      EXPECT_TRUE(query.on_reply(reader.reply(), now_ns));
      now_ns += 130'000;
    }
    return query.reading();
  }

  int baud;
  std::int64_t thinks_ns;
  int answers_right;  ///< so often it tells its time
  std::vector<std::string> requests;
};

TEST(ScipTimeQuery, FindsTheDevicesTimeWhateverTheLineTakes) {
  for (const int baud : {0, 19200, 57600, 115200, 750000}) {
    TimedLine line(baud);
    const std::optional<ClockReading> reading = line.asked();
    ASSERT_TRUE(reading) << baud;
    const std::int64_t true_ns = 100 * kSecond + (static_cast<std::int64_t>(reading->device_ms) - 5000) * kMs;
    EXPECT_NEAR(static_cast<double>(reading->host_ns - true_ns), 0.5 * kMs, 0.8 * kMs) << baud;
    EXPECT_EQ(line.requests.front(), "TM0\n");
    EXPECT_EQ(line.requests.back(), "TM2\n");
    EXPECT_EQ(std::ranges::count(line.requests, "TM1\n"), 8);
  }
}

TEST(ScipTimeQuery, AnswersThatComeTooLateTellNothing) {
  TimedLine line(0, 25 * kMs);
  EXPECT_FALSE(line.asked());
  EXPECT_THAT(line.requests, ::testing::ElementsAre("TM0\n", "TM2\n")) << "it is not asked on";
}

TEST(ScipTimeQuery, OnASlowLineAnswersAreNotTooLate) {
  TimedLine line(4800, 2 * kMs);
  EXPECT_TRUE(line.asked());
}

TEST(ScipTimeQuery, ADeviceThatTellsItNoMoreIsAskedNoMoreAndWhatItToldCounts) {
  TimedLine line(0, kMs, 2);
  EXPECT_TRUE(line.asked());
  EXPECT_THAT(line.requests, ::testing::ElementsAre("TM0\n", "TM1\n", "TM1\n", "TM1\n", "TM2\n"));
  TimedLine mute(0, kMs, 0);
  EXPECT_FALSE(mute.asked());
}

}  // namespace
}  // namespace odoless
