#include "firmware/web/web_guard.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace odoless {
namespace {

const std::vector<std::string> kNames{"localhost", "robot", "robot.local"};

WebRequest get_from(const std::string& host) { return {.method = "GET", .hosts = {host}}; }

TEST(WebGuard, ServesWhoeverAsksForThisHostByANameThatIsItsOwn) {
  for (const char* const host : {"127.0.0.1:8080", "192.168.1.7", "[::1]:8080", "[fe80::1]", "localhost",
                                 "LOCALHOST:80", "robot:8080", "robot.local"}) {
    EXPECT_EQ(refusal_of(get_from(host), kNames), 0) << host;
  }
}

TEST(WebGuard, RefusesANameThatAStrangerMayHaveLetPointHere) {
  for (const char* const host :
       {"", "evil.example", "robot.evil.example", "localhost.evil.example", "127.0.0.1.evil.example",
        "evil.example:8080", "127.0.0.1@evil.example", "[::1", "::1", "[::1]x", "127.1", "0x7f000001", "localhost:80x",
        "localhost:80:80", "robot.local.", " localhost"}) {
    EXPECT_EQ(refusal_of(get_from(host), kNames), 421) << host;
  }
  EXPECT_EQ(refusal_of({.method = "GET"}, kNames), 421);
  EXPECT_EQ(refusal_of({.method = "GET", .hosts = {"localhost", "localhost"}}, kNames), 421);
}

TEST(WebGuard, RefusesEveryMethodButGet) {
  for (const char* const method : {"POST", "PUT", "DELETE", "OPTIONS", "HEAD", "get", ""}) {
    EXPECT_EQ(refusal_of({.method = method, .hosts = {"localhost"}}, kNames), 405) << method;
  }
}

TEST(WebGuard, RefusesPagesOfAnotherOrigin) {
  WebRequest request = get_from("localhost:8080");
  request.origin = "http://localhost:8080";
  EXPECT_EQ(refusal_of(request, kNames), 0);
  for (const char* const origin : {"http://localhost:8081", "http://localhost", "https://localhost:8080", "null",
                                   "http://localhost:8080.evil.example"}) {
    request.origin = origin;
    EXPECT_EQ(refusal_of(request, kNames), 403) << origin;
  }
}

TEST(WebGuard, FollowsALinkAndRefusesWhatElseAnotherPageAsksFor) {
  WebRequest request = get_from("localhost:8080");
  for (const char* const site : {"cross-site", "same-site"}) {
    request.fetch_site = site;
    request.fetch_mode = "navigate";
    request.fetch_destination = "document";
    EXPECT_EQ(refusal_of(request, kNames), 0) << site;
    request.fetch_destination = "iframe";
    EXPECT_EQ(refusal_of(request, kNames), 403) << site;
    request.fetch_mode = "no-cors";
    request.fetch_destination = "image";
    EXPECT_EQ(refusal_of(request, kNames), 403) << site;
  }
  for (const char* const site : {"same-origin", "none"}) {
    request.fetch_site = site;
    EXPECT_EQ(refusal_of(request, kNames), 0) << site;
  }
}

TEST(WebGuard, KnowsItsOwnNames) {
  const std::vector<std::string> names = own_names("robot.lan");
  EXPECT_TRUE(is_own_host("localhost", names));
  EXPECT_TRUE(is_own_host("robot.lan:8080", names));
  EXPECT_FALSE(is_own_host("robot.lan:8080", own_names("")));
}

RC_GTEST_PROP(WebGuard, NoOtherTextIsAHost, ()) {
  const auto host = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("localhst[]:.1@ \0x/", 18)));
  const bool is_own = is_own_host(host, kNames);
  const std::string before_port = host.substr(0, host.rfind(':'));
  RC_ASSERT(!is_own || before_port == "localhost" || host == "localhost" ||
            before_port.find_first_not_of("0123456789.[]:") == std::string::npos);
}

}  // namespace
}  // namespace odoless
