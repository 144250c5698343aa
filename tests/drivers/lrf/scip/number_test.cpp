#include "drivers/lrf/scip/number.hpp"

#include <gtest/gtest.h>

namespace odoless::scip {
namespace {

// Worked examples of the protocol's published description.
TEST(ScipNumber, SumsAreThoseOfThePublishedExamples) {
  EXPECT_EQ(checksum("PROT:SCIP 2.0"), 'N');
  EXPECT_EQ(checksum("DMAX:5600"), '_');
  EXPECT_EQ(checksum("MODL:URG-04LX(Hokuyo Automatic Co.,Ltd.)"), 'N');
  EXPECT_EQ(checksum("00"), 'P');
  EXPECT_EQ(checksum("99"), 'b');
  EXPECT_EQ(checksum("02"), 'R');
  EXPECT_EQ(checksum("0E"), 'e');
  EXPECT_TRUE(sum_matches("00P"));
  EXPECT_FALSE(sum_matches("00Q"));
  EXPECT_FALSE(sum_matches("P"));
  EXPECT_FALSE(sum_matches(""));
}

TEST(ScipNumber, DecodesThePublishedExamples) {
  EXPECT_EQ(decode("CB"), 1234U);
  EXPECT_EQ(decode("1Dh"), 5432U);
  EXPECT_EQ(decode("m2@0"), 16'000'000U);
  EXPECT_EQ(decode(""), 0U);
}

TEST(ScipNumber, EncodingIsUndoneByDecoding) {
  for (std::uint32_t value = 0; value < 64; ++value) {
    const char c = encode(value);
    EXPECT_EQ(decode({&c, 1}), value);
    EXPECT_TRUE(is_encoded({&c, 1}));
  }
}

TEST(ScipNumber, KnowsWhichCharactersCanStandInANumber) {
  for (int c = -128; c < 128; ++c) {
    const char character = static_cast<char>(c);
    EXPECT_EQ(is_encoded({&character, 1}), c >= 0x30 && c < 0x70) << c;
  }
}

}  // namespace
}  // namespace odoless::scip
