#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "tests/support/run_command.hpp"
#include "tools/command/config.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;

TEST(Config, DefaultsAreACompleteConfigurationFile) {
  const Outcome defaults = run({"config", "defaults", "--all"});
  ASSERT_EQ(defaults.status, 0);
  EXPECT_THAT(defaults.out, HasSubstr("cell_size_m"));
  DaemonParams params;
  EXPECT_NO_THROW(parse_parameters(defaults.out, "defaults", params));
}

TEST(Config, TheFileToBeginWithIsShortAndEachOfItsLinesIsAccepted) {
  const Outcome defaults = run({"config", "defaults"});
  ASSERT_EQ(defaults.status, 0);
  const std::string used = std::regex_replace(defaults.out, std::regex("(^|\n)#(?! )"), "$1");
  EXPECT_THAT(used, HasSubstr("\nturn_rate_max_degps = 401.1\n"));
  EXPECT_LE(common_keys().size(), 40U);
  for (const std::string_view key : common_keys()) {
    EXPECT_THAT(used, HasSubstr(std::string("\n").append(key.substr(key.rfind('.') + 1)) + " = ")) << key;
  }
  DaemonParams params;
  EXPECT_NO_THROW(parse_parameters(used, "defaults", params));
}

TEST(Config, ReferenceHasEveryKey) {
  const Outcome reference = run({"config", "reference"});
  EXPECT_EQ(reference.status, 0);
  EXPECT_THAT(reference.out, HasSubstr("matcher.score_min"));
}

}  // namespace
}  // namespace odoless
