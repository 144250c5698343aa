#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "tests/config/example_params.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

TEST(WriteToml, IsCommentedWithMeaningAndRange) {
  EXPECT_EQ(write_toml(ExampleOuterParams{}), R"([matcher]
# Side of an NDT cell. Range: 0.1 to 20 m
cell_size_m = 1.0
# Number of particles. Range: 1 to 1000
particles = 100
# Where chance starts. Range: 0 to 9223372036854775807
seed = 1
# Whether a Newton step ends the search.
refine = true
# NDT's colour. Range: "red" or "green" or "blue"
colour = "green"
# Path of the laser.
device = "/dev/laser"
# Where nothing is seen. Range: at most 16 pairs of -360 to 360 deg
blind = []

[matcher.inner]
# Widest turn searched. Range: 0 to 180 deg
yaw_max_deg = 20.0
# Share of a | that is kept. Range: 0 to 1
gain = 0.5
# Time between scans. Range: 1e-06 to 10000 ms
period_ms = 100.0
)");
}

TEST(WriteToml, PutsTheFilesTopBeforeItsTables) {
  const std::string toml = write_toml(ExampleParams{});
  EXPECT_LT(toml.find("refine"), toml.find("[inner]"));
  ExampleParams read;
  EXPECT_NO_THROW(parse_parameters(toml, "f", read));
}

void expect_equal(const ExampleParams& a, const ExampleParams& b) {
  RC_ASSERT(a.cell_size_m == b.cell_size_m);
  RC_ASSERT(a.particles == b.particles);
  RC_ASSERT(a.seed == b.seed);
  RC_ASSERT(a.refine == b.refine);
  RC_ASSERT(a.colour == b.colour);
  RC_ASSERT(a.device == b.device);
  RC_ASSERT(a.inner.gain == b.inner.gain);
  RC_ASSERT(a.inner.period_ns == b.inner.period_ns);
}

double real_within(double low, double high) {
  const auto share = static_cast<double>(*rc::gen::arbitrary<std::uint32_t>()) * 0x1p-32;
  return low + (high - low) * share;
}

ExampleParams arbitrary_params() {
  ExampleParams params;
  params.cell_size_m = real_within(0.1, 20.0);
  params.particles = *rc::gen::inRange(1, 1001);
  params.seed = *rc::gen::suchThat<std::int64_t>([](std::int64_t seed) { return seed >= 0; });
  params.refine = *rc::gen::arbitrary<bool>();
  params.colour = static_cast<ExampleColour>(*rc::gen::inRange(0, 3));
  params.device = *rc::gen::container<std::string>(rc::gen::inRange<char>(' ', '~'));
  params.inner.gain = real_within(0.0, 1.0);
  params.inner.yaw_max_rad = real_within(0.0, 3.14);
  params.inner.period_ns = *rc::gen::inRange<std::int64_t>(1, 10'000'000'001);
  return params;
}

TEST(WriteToml, IsReadBackExactly) {
  EXPECT_TRUE(rc::check([] {
    const ExampleParams written = arbitrary_params();
    ExampleParams read;
    parse_parameters(write_toml(written), "f", read);
    expect_equal(read, written);
    RC_ASSERT(std::abs(read.inner.yaw_max_rad - written.inner.yaw_max_rad) <= 1e-15);
  }));
}

TEST(WriteToml, OfWhatAFileSaidIsReadBackExactly) {
  EXPECT_TRUE(rc::check([] {
    ExampleInnerParams once;
    parse_parameters("yaw_max_deg = " + std::to_string(real_within(0.0, 180.0)), "f", once);
    ExampleInnerParams twice;
    parse_parameters(write_toml(once), "f", twice);
    RC_ASSERT(once.yaw_max_rad == twice.yaw_max_rad);
  }));
}

// A default that no number of degrees gives must survive too, or writing the defaults to a file would change a run.
TEST(WriteToml, KeepsEveryBitOfADefault) {
  EXPECT_TRUE(rc::check([] {
    ExampleInnerParams defaults;
    defaults.yaw_max_rad = real_within(0.0, 3.14);
    ExampleInnerParams read = defaults;
    parse_parameters(write_toml(defaults), "f", read);
    RC_ASSERT(read.yaw_max_rad == defaults.yaw_max_rad);
  }));
}

TEST(WriteToml, KeepsSectorsAsTheyWereWritten) {
  ExampleParams params;
  parse_parameters("blind = [[170, -170], [12.5, 30]]", "f", params);
  EXPECT_THAT(write_toml(params), HasSubstr("\nblind = [[170.0, -170.0], [12.5, 30.0]]\n"));
  ExampleParams read;
  parse_parameters(write_toml(params), "f", read);
  ASSERT_EQ(read.blind.size(), 2U);
  EXPECT_EQ(read.blind[0].from_rad, params.blind[0].from_rad);
  EXPECT_EQ(read.blind[1].to_rad, params.blind[1].to_rad);
}

struct RadianParams {
  double turn_max_rad = 0.35;
  bool raw_bytes = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("turn_max_rad", self.turn_max_rad, Range{0.01, 3.1416}, "Turn.");
    visit.flag("raw_bytes", self.raw_bytes, "Whether bytes are sent.");
  }
};

TEST(WriteTemplate, HasTheKeysThatWereAskedForAsCommentsInFewDigits) {
  constexpr std::array<std::string_view, 1> kKeys{"turn_max_deg"};
  EXPECT_EQ(write_template(RadianParams{}, kKeys), "# Turn. Range: 0.573 to 180 deg\n#turn_max_deg = 20.05\n");
}

// Rounded ends lie within the true ones, so that whatever the text promises is accepted.
TEST(WriteReference, SaysLimitsInFewDigitsThatHold) {
  EXPECT_THAT(write_reference(RadianParams{}), HasSubstr("| number | 20.05 | 0.573 to 180 | deg |"));
  RadianParams params;
  EXPECT_NO_THROW(parse_parameters("turn_max_deg = 0.573", "f", params));
  EXPECT_NO_THROW(parse_parameters("turn_max_deg = 180", "f", params));
}

TEST(WriteReference, GivesNumbersAloneAUnit) {
  EXPECT_THAT(write_reference(RadianParams{}), HasSubstr("| `raw_bytes` | boolean | false |  |  |"));
}

TEST(WriteReference, HasOneRowPerKey) {
  const std::string page = write_reference(ExampleOuterParams{});
  EXPECT_THAT(page, HasSubstr("| `matcher.cell_size_m` | number | 1.0 | 0.1 to 20 | m | Side of an NDT cell. |\n"));
  EXPECT_THAT(page,
              HasSubstr("| `matcher.inner.yaw_max_deg` | number | 20.0 | 0 to 180 | deg | Widest turn searched. |\n"));
  EXPECT_THAT(page,
              HasSubstr("| `matcher.refine` | boolean | true |  |  | Whether a Newton step ends the search. |\n"));
  EXPECT_THAT(page, HasSubstr("Share of a \\| that is kept."));
  EXPECT_EQ(std::count(page.begin(), page.end(), '\n'), 2 + 10);
}

}  // namespace
}  // namespace odoless
