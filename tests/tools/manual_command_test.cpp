#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/run_command.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Manual, NamesEveryCommandWithItsOptionsAndDefaults) {
  const Outcome page = run({"manual"});
  ASSERT_EQ(page.status, 0);
  EXPECT_THAT(page.out, HasSubstr(".TH ODOLESS 1 "));
  EXPECT_THAT(page.out, HasSubstr("\n.SS odoless eval relations\n"));
  EXPECT_THAT(page.out, HasSubstr("\n\\fB\\-\\-seed\\fR"));
  EXPECT_THAT(page.out, HasSubstr("Random seed: the same seed gives the same bytes (default: 1)\n"));
  EXPECT_THAT(page.out, Not(HasSubstr("\\fI\\fR")));
}

TEST(Manual, OfTheDaemonHasItsOptions) {
  const Outcome page = run({"manual", "odolessd"});
  ASSERT_EQ(page.status, 0);
  EXPECT_THAT(page.out, HasSubstr(".TH ODOLESSD 8 "));
  EXPECT_THAT(page.out, HasSubstr("\\fB\\-\\-require\\-realtime\\fR\n"));
  EXPECT_EQ(run({"manual", "other"}).status, 64);
}

TEST(Completion, HasTheWordsThatCanFollowEachCommand) {
  const Outcome bash = run({"completion", "bash"});
  ASSERT_EQ(bash.status, 0);
  EXPECT_THAT(bash.out, HasSubstr("'odoless config') candidates='reference defaults --"));
  EXPECT_THAT(bash.out, HasSubstr("complete -o default -F _odolessd odolessd\n"));
  const Outcome zsh = run({"completion", "zsh"});
  ASSERT_EQ(zsh.status, 0);
  EXPECT_THAT(zsh.out, ::testing::StartsWith("#compdef odoless odolessd\n"));
  EXPECT_EQ(run({"completion", "tcsh"}).status, 64);
}

}  // namespace
}  // namespace odoless
