#include "tools/output/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

namespace odoless {
namespace {

using ::testing::HasSubstr;

std::int64_t clock_ns = 0;
std::int64_t fake_clock() { return clock_ns; }

/// What `job` writes to a terminal.
template <class Job>
std::string shown(Job job) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  job(file.get());
  std::rewind(file.get());
  std::string text(100'000, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  return text;
}

TEST(Progress, LineTellsShareRateAndTimeLeft) {
  EXPECT_EQ(format_progress({.done = 500, .total = 1000, .elapsed_s = 65.0}, "fitness 0.93"),
            "[############............]  50 %  500/1000  7.7/s  1:05 left  fitness 0.93");
}

TEST(Progress, LineStaysSoundAtItsLimits) {
  EXPECT_THAT(format_progress({}, ""), HasSubstr("0 %  0/0"));
  EXPECT_THAT(format_progress({.done = 9, .total = 3, .elapsed_s = 1.0}, ""),
              HasSubstr("100 %  9/3  9.0/s  0:00 left"));
  EXPECT_THAT(format_progress({.done = 999, .total = 1000, .elapsed_s = 1.0}, ""), HasSubstr(" 99 %"));
  EXPECT_LE(format_progress({.done = 1, .total = 2}, std::string(500, 'x')).size(), 100U);
}

TEST(Progress, RedrawsAtMostTenTimesASecondAndAtTheEnd) {
  const std::string text = shown([](std::FILE* terminal) {
    clock_ns = 0;
    Progress progress(1000, terminal, fake_clock);
    for (int done = 1; done <= 1000; ++done) {
      clock_ns += 1'000'000;
      progress.update(done, "note");
    }
  });
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 11);
  EXPECT_THAT(text, HasSubstr("1000/1000"));
  EXPECT_TRUE(text.ends_with('\n'));
}

TEST(Progress, WritesALineEveryHalfMinuteIntoAPipeThatWantsThem) {
  const std::string text = shown([](std::FILE* pipe) {
    clock_ns = 0;
    Progress progress(100, pipe, fake_clock, false);
    for (int done = 1; done <= 100; ++done) {
      clock_ns += 1'000'000'000;
      progress.update(done, "note");
    }
  });
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 0);
  EXPECT_THAT(text, HasSubstr("30/100"));
}

TEST(Progress, LeavesNothingOfAShortJobWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  for (const InPipe in_pipe : {InPipe::kNothing, InPipe::kLines}) {
    Progress progress(10, in_pipe);
    progress.update(10, "note");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace odoless
