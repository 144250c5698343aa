// What is said of robots that were put into a world: how many were told where they are, when, and how many wrongly.
#include "tools/replay/places.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace odoless {
namespace {

using ::testing::HasSubstr;

TEST(Places, AreReportedAsWhatTheUserAsksFor) {
  const std::vector<TriedPlace> tried{
      {.is_seen = true, .told_after_s = 2.0, .sure_after_s = 8.0, .errors_m = {0.1, 0.2}},
      {.told_after_s = 12.0, .sure_after_s = 12.0, .wrong_scans = 3, .errors_m = {0.1, 4.0}},
      {.is_seen = true, .guessed_scans = 7, .wrong_guesses = 7},
  };
  const Report said = report(tried, {.in_time_s = 10.0});
  EXPECT_EQ(said.json["told"], 2U);
  EXPECT_EQ(said.json["told_in_time"], 1) << "one after 12 s, one never";
  EXPECT_EQ(said.json["seen"], 2);
  EXPECT_EQ(said.json["seen_told_in_time"], 1);
  EXPECT_EQ(said.json["sure"], 2U);
  EXPECT_EQ(said.json["wrong"], 1);
  EXPECT_DOUBLE_EQ(said.json["error_max_m"].get<double>(), 4.0);
  EXPECT_THAT(said.text, HasSubstr("in 2 of 3 places, in 1 within 10 s"));
  EXPECT_THAT(said.text,
              HasSubstr("2 of 3 places (a scan of the world is from within 2 m): the right pose within 10 s in 1 of"));
  EXPECT_THAT(said.text, HasSubstr("wrong while OK   in 1 of 3 places"));
  EXPECT_THAT(said.text, HasSubstr("7 of 7 scans wrong"));
}

TEST(Places, OfNoneSayNone) { EXPECT_THAT(report({}, {}).text, HasSubstr("in 0 of 0 places")); }

}  // namespace
}  // namespace odoless
