#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <utility>

#include "drivers/lrf/scip/number.hpp"
#include "tests/firmware/lrf_bench.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::Device;
using test::kMs;
using test::kSecond;
using test::sick_params;
using test::SlowSick;

/// A SICK that stops when it is told to, and answers nothing else.
class HalfDeafSick final : public Device {
 public:
  std::string work(std::string_view received, std::int64_t /*now_ns*/) override {
    const bool is_stop = received.size() >= 7 && received[4] == '\x20' && received[5] == '\x25';
    return is_stop ? '\x06' + SlowSick::telegram(std::string("\xA0\0", 2)) : "";
  }
};

/// A Hokuyo that takes its time for each answer, and does not answer all.
class LazyHokuyo final : public Device {
 public:
  LazyHokuyo(std::string ignored, std::int64_t takes_ns) : ignored_(std::move(ignored)), takes_ns_(takes_ns) {}

  std::string work(std::string_view received, std::int64_t now_ns) override {
    heard_ += received;
    for (std::size_t end = heard_.find('\n'); end != std::string::npos; end = heard_.find('\n')) {
      const std::string request = heard_.substr(0, end);
      heard_.erase(0, end + 1);
      if (!request.empty() && !request.starts_with(ignored_)) {
        waiting_.push_back({now_ns + takes_ns_, answer_to(request)});
      }
    }
    std::string sent;
    for (; !waiting_.empty() && waiting_.front().at_ns <= now_ns; waiting_.pop_front()) {
      sent += waiting_.front().bytes;
    }
    return sent;
  }

 private:
  struct Waiting {
    std::int64_t at_ns;
    std::string bytes;
  };

  static std::string answer_to(const std::string& request) {
    const std::string done = request + "\n00P\n";
    return request != "PP"
               ? done + '\n'
               : done + line("MODL:UTM-30LX(Hokuyo)") + line("DMIN:23") + line("DMAX:60000") + line("ARES:1440") +
                     line("AMIN:0") + line("AMAX:1080") + line("AFRT:540") + line("SCAN:2400") + '\n';
  }
  static std::string line(const std::string& text) { return text + ';' + scip::checksum(text) + '\n'; }

  std::string ignored_;
  std::int64_t takes_ns_;
  std::string heard_;
  std::deque<Waiting> waiting_;
};

LrfParams hokuyo_params() {
  LrfParams params;
  params.device = "/dev/ttyACM0";
  return params;
}

TEST(LrfSource, TellsOnceOfALaserThatDoesNotAnswerAllAndAsksAgain) {
  for (const auto& [ignored, takes_ns] :
       {std::pair<std::string, std::int64_t>{"PP", 5 * kMs}, {"MD", 5 * kMs}, {"PP", 100 * kMs}, {"none", 230 * kMs}}) {
    SCOPED_TRACE(ignored + " after " + std::to_string(takes_ns / kMs));
    LazyHokuyo laser(ignored, takes_ns);
    Bench bench(laser, hokuyo_params());
    bench.run(5 * kSecond);
    EXPECT_EQ(bench.heard.times("not all that it is asked"), 1) << ::testing::PrintToString(bench.heard.told);
    EXPECT_EQ(bench.heard.times("lrf.reply_timeout_ms (200 ms)"), 1);
    bench.run(60 * kSecond);
    EXPECT_GE(bench.reopened, 10);
    EXPECT_LE(bench.heard.told.size(), 3U) << ::testing::PrintToString(bench.heard.told);
  }
  HalfDeafSick laser;
  Bench bench(laser);
  bench.run(60 * kSecond);
  EXPECT_EQ(bench.heard.times("not all that it is asked"), 1) << ::testing::PrintToString(bench.heard.told);
}

TEST(LrfSource, WaitsForAnswersAsLongAsTheReplyTimeoutSays) {
  LazyHokuyo laser("none", 700 * kMs);
  LrfParams params = hokuyo_params();
  params.reply_timeout_ns = 1 * kSecond;
  Bench bench(laser, params);
  bench.run(10 * kSecond);
  EXPECT_EQ(bench.heard.times("streaming, 1081 beams"), 1) << ::testing::PrintToString(bench.heard.told);
  EXPECT_EQ(bench.heard.times("not all that it is asked"), 0);
}

}  // namespace
}  // namespace odoless
