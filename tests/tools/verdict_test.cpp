#include "tools/replay/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr RunFigures kGood{
    .scans = 10'000, .lost = 5, .doubtful = 50, .poor = 20, .ambiguous = 900, .duration_s = 2000};

TEST(Verdict, OfARunThatTracksIsGood) {
  const Verdict verdict = judge(kGood);
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_THAT(verdict.reasons, IsEmpty());
  EXPECT_EQ(sentence(verdict), "result: good");
}

TEST(Verdict, NamesEachReasonWithItsShare) {
  RunFigures figures = kGood;
  figures.lost = 120;
  figures.missing_s = 100.0;
  const Verdict verdict = judge(figures);
  EXPECT_EQ(verdict.grade, Grade::kDoubtful);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("120 of 10000 scans (1.2 %)"), HasSubstr("100 s of 2000 s")));
  EXPECT_THAT(sentence(verdict), testing::StartsWith("result: doubtful: 120 of 10000"));
}

TEST(Verdict, GrowsWorseWithEveryFigure) {
  for (const auto figure : {&RunFigures::lost, &RunFigures::doubtful, &RunFigures::poor, &RunFigures::ambiguous,
                            &RunFigures::outside, &RunFigures::untimed}) {
    Grade before = Grade::kGood;
    for (std::int64_t count = 0; count <= kGood.scans; count += 100) {
      RunFigures figures{.scans = kGood.scans};
      figures.*figure = count;
      const Verdict verdict = judge(figures);
      EXPECT_GE(verdict.grade, before);
      EXPECT_EQ(verdict.reasons.empty(), verdict.grade == Grade::kGood);
      before = verdict.grade;
    }
    EXPECT_NE(before, Grade::kGood) << "all scans are bad";
  }
}

TEST(Verdict, FailsWhereTheWorstIsTrueAndSaysThatFirst) {
  RunFigures figures = kGood;
  figures.doubtful = 5000;
  figures.lost = 4000;
  EXPECT_EQ(judge(figures).grade, Grade::kFailed);
  figures.lost = 0;
  figures.poor = 9000;
  const Verdict verdict = judge(figures);
  EXPECT_EQ(verdict.grade, Grade::kFailed);
  EXPECT_THAT(verdict.reasons.front(), HasSubstr("poorly"));
  figures = {.scans = 10, .is_mapped = false};
  EXPECT_EQ(judge(figures).grade, Grade::kFailed);
}

TEST(Verdict, IsInTheSummary) {
  RunFigures figures = kGood;
  figures.poor = 1000;
  nlohmann::ordered_json summary;
  add_verdict(figures, judge(figures), summary);
  EXPECT_EQ(summary["result"], "doubtful");
  EXPECT_EQ(summary["reasons"].size(), 1U);
  EXPECT_DOUBLE_EQ(summary["poor_share"].get<double>(), 0.1);
}

}  // namespace
}  // namespace odoless
