#include "tools/log/stamp.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

TEST(Stamp, IsExactToTheNanosecond) {
  EXPECT_EQ(parse_stamp_ns("1282836370.970876123"), 1'282'836'370'970'876'123);
  EXPECT_EQ(parse_stamp_ns("1211.520329"), 1'211'520'329'000);
  EXPECT_EQ(parse_stamp_ns("1.01893e+09"), 1'018'930'000'000'000'000);
  EXPECT_EQ(parse_stamp_ns("15E-1"), 1'500'000'000);
  EXPECT_EQ(parse_stamp_ns("-0.25"), -250'000'000);
  EXPECT_EQ(parse_stamp_ns(".5"), 500'000'000);
  EXPECT_EQ(parse_stamp_ns("7."), 7'000'000'000);
  EXPECT_EQ(parse_stamp_ns("0"), 0);
  EXPECT_EQ(parse_stamp_ns("000.000e5"), 0);
}

TEST(Stamp, RoundsBelowANanosecond) {
  EXPECT_EQ(parse_stamp_ns("0.0000000014"), 1);
  EXPECT_EQ(parse_stamp_ns("0.0000000015"), 2);
  EXPECT_EQ(parse_stamp_ns("0.9999999996"), 1'000'000'000);
  EXPECT_EQ(parse_stamp_ns("1e-300"), 0);
}

TEST(Stamp, RefusesWhatIsNoStamp) {
  for (const char* const text : {"", "-", ".", "e5", "1e", "1e+", "1e5x", "1.2.3", "nan", "inf", "--1", "1 ", "0x10",
                                 "9223372037", "-9223372037", "1e300", "1e99999999999", "99999999999999999999"}) {
    EXPECT_FALSE(parse_stamp_ns(text).has_value()) << text;
  }
  EXPECT_EQ(parse_stamp_ns("9223372036.854775807"), 9'223'372'036'854'775'807) << "the largest";
  EXPECT_FALSE(parse_stamp_ns("9223372036.854775808").has_value());
}

TEST(Stamp, ReadsBackEveryPrintedStamp) {
  Rng rng(1);
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t stamp_ns =
        (static_cast<std::int64_t>(rng.next() >> 1U) << 31U | rng.next() >> 1U) >> rng.below(62);
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%lld.%09lld", static_cast<long long>(stamp_ns / 1'000'000'000),
                  static_cast<long long>(stamp_ns % 1'000'000'000));
    EXPECT_EQ(parse_stamp_ns(text.data()), stamp_ns) << text.data();
  }
}

TEST(Stamp, TellsWhetherStampsAreOfUse) {
  using Stamps = std::array<std::int64_t, 3>;
  EXPECT_TRUE(stamps_are_usable(Stamps{1, 2, 3}));
  EXPECT_TRUE(stamps_are_usable(Stamps{0, 0, 3}));
  EXPECT_TRUE(stamps_are_usable(Stamps{5, 4, 3}));
  EXPECT_FALSE(stamps_are_usable(Stamps{0, 0, 0}));
  EXPECT_FALSE(stamps_are_usable(Stamps{7, 7, 7}));
  EXPECT_FALSE(stamps_are_usable({}));
  EXPECT_TRUE(stamps_are_usable(std::array<std::int64_t, 1>{7}));
}

}  // namespace
}  // namespace odoless
