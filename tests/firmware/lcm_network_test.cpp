#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "firmware/lcm/lcm_link.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/private_network.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

TEST(LcmNetwork, OneThatIsMissingIsSaidInOneLineAndUsedWhenItIsThere) {
  if (const std::string why = test::enter_dead_network(); !why.empty()) {
    GTEST_SKIP() << "no network of its own for this test: " << why;
  }
  for (const std::string& url : {test::lcm_url(), std::string("udpm://"), LcmParams{}.url}) {
    SCOPED_TRACE(url);
    LcmParams params;
    params.url = url;
    LcmLink link(params, 1'000'000);
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(link.open(), Errc::kUnavailable);
    EXPECT_EQ(link.open(), Errc::kUnavailable);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "the log is the daemon's";
    EXPECT_THAT(link.reason(), HasSubstr("ip route add 224.0.0.0/4 dev lo"));
    EXPECT_EQ(link.reason().find('\n'), std::string::npos);
  }
  ASSERT_EQ(test::raise_network(), "");
  LcmParams params;
  params.url = test::lcm_url();
  LcmLink link(params, 1'000'000);
  ASSERT_EQ(link.open(), Errc::kOk) << link.reason();
  EXPECT_EQ(link.publish(test::example_motion()), Errc::kOk);
}

}  // namespace
}  // namespace odoless
