#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tests/config/example_params.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

ExampleOuterParams parsed(std::string_view toml) {
  ExampleOuterParams params;
  parse_parameters(toml, "robot.toml", params);
  return params;
}

std::vector<std::string> problems_of(std::string_view toml) {
  try {
    static_cast<void>(parsed(toml));
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(ParseParameters, SetsEveryKind) {
  const ExampleParams params = parsed(R"([matcher]
cell_size_m = 2.5
particles = 7
seed = 9223372036854775807
refine = false
colour = "blue"
device = "udpm://239.255.76.67:7667"
blind = [[170, -170.0], [30, 45.5]]
inner.yaw_max_deg = 90
inner.period_ms = 12.5
)")
                                   .matcher;
  EXPECT_EQ(params.cell_size_m, 2.5);
  EXPECT_EQ(params.particles, 7);
  EXPECT_EQ(params.seed, INT64_MAX);
  EXPECT_FALSE(params.refine);
  EXPECT_EQ(params.colour, ExampleColour::kBlue);
  EXPECT_EQ(params.device, "udpm://239.255.76.67:7667");
  ASSERT_EQ(params.blind.size(), 2U);
  EXPECT_DOUBLE_EQ(params.blind[0].to_rad, -170.0 * std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(params.blind[1].from_rad, std::numbers::pi / 6.0);
  EXPECT_DOUBLE_EQ(params.inner.yaw_max_rad, std::numbers::pi / 2.0);
  EXPECT_EQ(params.inner.period_ns, 12'500'000);
}

TEST(ParseParameters, RefusesSectorsThatAreNone) {
  for (const char* const wrong :
       {"30", "[30, 40]", "[[30]]", "[[1, 2, 3]]", "[[\"a\", 2]]", "[[0, 361]]", "[[nan, 1]]", "[[1, 2], 3]"}) {
    EXPECT_THAT(problems_of(std::string("[matcher]\nblind = ") + wrong),
                ElementsAre(HasSubstr("must be a list of sectors [from, to], at most 16 pairs of -360 to 360 deg")))
        << wrong;
  }
  std::string many = "[0, 1]";
  for (int i = 0; i < 16; ++i) {
    many += ", [0, 1]";
  }
  EXPECT_EQ(problems_of("[matcher]\nblind = [" + many + "]").size(), 1U);
  EXPECT_THAT(problems_of("[matcher]\nblind = []"), IsEmpty());
}

TEST(ParseParameters, LeavesWhatIsNotNamed) {
  const ExampleParams defaults;
  const ExampleParams params = parsed("[matcher.inner]\ngain = 0.25\n").matcher;
  EXPECT_EQ(params.inner.gain, 0.25);
  EXPECT_EQ(params.inner.yaw_max_rad, defaults.inner.yaw_max_rad);
  EXPECT_EQ(params.cell_size_m, defaults.cell_size_m);
  EXPECT_EQ(params.colour, defaults.colour);
  EXPECT_EQ(parsed("").matcher.particles, defaults.particles);
}

TEST(ParseParameters, TakesAnIntegerForARealNumber) {
  EXPECT_EQ(parsed("matcher.cell_size_m = 4").matcher.cell_size_m, 4.0);
}

TEST(ParseParameters, TakesBothEndsOfARangeAndStaysWithin) {
  EXPECT_TRUE(parameters_in_range(parsed("matcher.inner.yaw_max_deg = 180\nmatcher.inner.period_ms = 10000")));
  EXPECT_TRUE(parameters_in_range(parsed("matcher.inner.yaw_max_deg = 0.0\nmatcher.inner.period_ms = 1e-6")));
  EXPECT_THAT(problems_of("matcher.inner.yaw_max_deg = 180.0001"), ElementsAre(HasSubstr("must be 0 to 180 (")));
}

TEST(ParseParameters, SaysWhereWhatAndWhatWouldBeRight) {
  EXPECT_THAT(problems_of("\n[matcher]\n# a comment\ncell_size_m = 99\n"),
              ElementsAre("robot.toml:4: key 'matcher.cell_size_m' = 99: must be 0.1 to 20 (side of an NDT cell)"));
}

struct Mistake {
  const char* toml;
  const char* problem;
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.toml; }

class ParseParametersMistake : public ::testing::TestWithParam<Mistake> {};

TEST_P(ParseParametersMistake, IsNamed) {
  EXPECT_THAT(problems_of(GetParam().toml), ElementsAre(std::string("robot.toml:1: ") + GetParam().problem));
}

INSTANTIATE_TEST_SUITE_P(
    Values, ParseParametersMistake,
    ::testing::Values(
        Mistake{"matcher.cell_size_m = nan",
                "key 'matcher.cell_size_m' = nan: must be 0.1 to 20 (side of an NDT cell)"},
        Mistake{"matcher.cell_size_m = -inf",
                "key 'matcher.cell_size_m' = -inf: must be 0.1 to 20 (side of an NDT cell)"},
        Mistake{"matcher.cell_size_m = 'two'",
                "key 'matcher.cell_size_m' = 'two': must be 0.1 to 20 (side of an NDT cell)"},
        Mistake{"matcher.cell_size_m = true",
                "key 'matcher.cell_size_m' = true: must be 0.1 to 20 (side of an NDT cell)"},
        Mistake{"matcher.cell_size_m = [1.0]",
                "key 'matcher.cell_size_m' is of type array: must be 0.1 to 20 (side of an NDT cell)"},
        Mistake{"matcher.cell_size_m.x = 1",
                "key 'matcher.cell_size_m' is of type table: must be 0.1 to 20 (side of an NDT cell)"},
        Mistake{"matcher.particles = 0",
                "key 'matcher.particles' = 0: must be a whole number, 1 to 1000 (number of particles)"},
        Mistake{"matcher.particles = 4294967297",
                "key 'matcher.particles' = 4294967297: must be a whole number, 1 to 1000 (number of particles)"},
        Mistake{"matcher.particles = 5.0",
                "key 'matcher.particles' = 5.0: must be a whole number, 1 to 1000 (number of particles)"},
        Mistake{"matcher.refine = 1",
                "key 'matcher.refine' = 1: must be true or false (whether a Newton step ends the search)"},
        Mistake{"matcher.colour = 'mauve'",
                "key 'matcher.colour' = 'mauve': must be \"red\" or \"green\" or \"blue\" (NDT's colour)"},
        Mistake{"matcher.colour = 1",
                "key 'matcher.colour' = 1: must be \"red\" or \"green\" or \"blue\" (NDT's colour)"},
        Mistake{"matcher.device = 1",
                "key 'matcher.device' = 1: must be a text of one line, at most 1024 bytes (path of the laser)"},
        Mistake{
            R"(matcher.device = "a\u007F")",
            R"(key 'matcher.device' = "a\u007F": must be a text of one line, at most 1024 bytes (path of the laser))"},
        Mistake{"matcher = 3", "key 'matcher' = 3: must be a table, [matcher]"},
        Mistake{"matcher.inner = 'x'", "key 'matcher.inner' = 'x': must be a table, [matcher.inner]"}));

INSTANTIATE_TEST_SUITE_P(
    UnknownKeys, ParseParametersMistake,
    ::testing::Values(Mistake{"matcher.cel_size_m = 1.0",
                              "unknown key 'matcher.cel_size_m': did you mean 'matcher.cell_size_m'?"},
                      Mistake{"cell_size_m = 1.0", "unknown key 'cell_size_m': did you mean 'matcher.cell_size_m'?"},
                      Mistake{"matcher.inner.yaw_max_rad = 1.0",
                              "unknown key 'matcher.inner.yaw_max_rad': did you mean 'matcher.inner.yaw_max_deg'?"},
                      Mistake{"odometry = 'yes'", "unknown key 'odometry': not a parameter"},
                      Mistake{"[wheels]\nradius_m = 1", "unknown key 'wheels': not a parameter"}));

TEST(ParseParameters, ReportsAllProblemsAtOnceAndChangesNothing) {
  ExampleOuterParams params;
  try {
    parse_parameters("[matcher]\nparticles = 5\ncell_size_m = 0\ncolor = 'red'\n[matcher.inner]\ngain = 2\n", "f",
                     params);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.problems(),
                ::testing::UnorderedElementsAre(StartsWith("f:3: "), StartsWith("f:4: "), StartsWith("f:6: ")));
    EXPECT_THAT(error.what(), HasSubstr("\n"));
  }
  EXPECT_EQ(params.matcher.particles, ExampleParams{}.particles);
}

TEST(ParseParameters, PlacesASyntaxErrorByLineAndColumn) {
  EXPECT_THAT(problems_of("[matcher]\ncell_size_m = = 1\n"), ElementsAre(StartsWith("robot.toml:2:15: ")));
  EXPECT_THAT(problems_of("[matcher]\nrefine = true\nrefine = true\n"), ElementsAre(StartsWith("robot.toml:3:")));
}

TEST(ParseParameters, RefusesDeepNestingWithoutHarm) {
  EXPECT_THAT(problems_of("x = " + std::string(100'000, '[')), ElementsAre(StartsWith("robot.toml:1:")));
}

// The sanitizers find here what the parser takes for unreachable.
TEST(ParseParameters, RefusesLettersBeyondAsciiWhereNoTextIs) {
  for (unsigned int letter = 0x80; letter < 0x800; ++letter) {  // those of two bytes
    const std::string bytes{static_cast<char>(0xc0U | letter >> 6U), static_cast<char>(0x80U | (letter & 0x3fU))};
    if (letter == 0x85 || letter == 0xa0) {
      continue;  // a line's end and a space to some
    }
    EXPECT_THAT(problems_of("[matcher]\n" + bytes + " = 1\n"), ElementsAre(StartsWith("robot.toml:2:1: "))) << letter;
    EXPECT_THAT(problems_of("[matcher]\ncell_size_m " + bytes + "= 1\n"), ElementsAre(StartsWith("robot.toml:2:")))
        << letter;
  }
}

// Every key of the description: absent it keeps its default, wrongly typed it is refused by name.
TEST(ParseParameters, RefusesAWrongTypeOfEveryKey) {
  ExampleOuterParams params;
  const std::vector<Entry> entries = entries_of(params);
  ASSERT_EQ(entries.size(), 10U);
  for (const Entry& entry : entries) {
    EXPECT_THAT(problems_of(entry.key + " = 1979-05-27"),
                ElementsAre(HasSubstr("key '" + entry.key + "' = 1979-05-27: must be ")));
    EXPECT_THAT(problems_of(entry.key + " = {}"),
                ElementsAre(HasSubstr("key '" + entry.key + "' is of type table: must be ")));
  }
}

TEST(LoadParameters, ReadsAFile) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "odoless_load_test.toml";
  std::ofstream(path) << "matcher.particles = 12\n";
  ExampleOuterParams params;
  load_parameters(path, params);
  EXPECT_EQ(params.matcher.particles, 12);
  std::filesystem::remove(path);
}

std::string error_of_loading(const std::filesystem::path& path) {
  ExampleOuterParams params;
  try {
    load_parameters(path, params);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(LoadParameters, SaysWhyAFileCannotBeRead) {
  EXPECT_EQ(error_of_loading("/nonexistent/robot.toml"),
            "/nonexistent/robot.toml: cannot be read: No such file or directory");
  EXPECT_EQ(error_of_loading("/"), "/: cannot be read: Is a directory");
  EXPECT_THAT(error_of_loading("/dev/zero"), HasSubstr("larger than 1 MiB"));
  EXPECT_THAT(error_of_loading("/dev/null"), IsEmpty());
}

}  // namespace
}  // namespace odoless
