#include "firmware/web/web_guard.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "firmware/daemon/web_commands.hpp"
#include "firmware/web/web_token.hpp"
#include "tests/support/temporary_folder.hpp"

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

TEST(WebGuard, TakesACommandAtItsPlaceAloneAndOfNoOtherOrigin) {
  WebRequest request{.method = "POST", .path = kCommandPath, .hosts = {"localhost:8080"}};
  EXPECT_EQ(refusal_of(request, kNames), 0);
  for (const char* const path : {"/", "/events", "/command/", "/commands", ""}) {
    request.path = path;
    EXPECT_EQ(refusal_of(request, kNames), 405) << path;
  }
  request.path = kCommandPath;
  request.origin = "http://localhost:8080";
  EXPECT_EQ(refusal_of(request, kNames), 0);
  request.origin = "http://evil.example";
  EXPECT_EQ(refusal_of(request, kNames), 403);
  request.origin = "";
  request.fetch_site = "cross-site";  // a form that a stranger's page sends, in place of the link that it is not
  request.fetch_mode = "navigate";
  request.fetch_destination = "document";
  EXPECT_EQ(refusal_of(request, kNames), 403);
  request.hosts = {"rebound.example"};
  EXPECT_EQ(refusal_of(request, kNames), 421);
  for (const char* const method : {"PUT", "DELETE", "OPTIONS", "HEAD", "PATCH"}) {
    EXPECT_EQ(refusal_of({.method = method, .path = kCommandPath, .hosts = {"localhost"}}, kNames), 405) << method;
  }
}

TEST(WebToken, AllowsWhoSaysItWhollyAndNobodyWithoutOne) {
  const WebToken token{"0123456789abcdef"};
  EXPECT_TRUE(token.allows("Bearer 0123456789abcdef"));
  for (const char* const wrong :
       {"", "Bearer", "Bearer ", "Bearer 0123456789abcde", "Bearer 0123456789abcdef0", "Bearer 0123456789abcdef ",
        "bearer 0123456789abcdef", "0123456789abcdef", "Bearer 0123456789abcdeF", "Basic 0123456789abcdef",
        "Bearer 0123456789abcdef0123456789abcdef"}) {
    EXPECT_FALSE(token.allows(wrong)) << wrong;
  }
  EXPECT_FALSE(WebToken{}.allows("Bearer "));
}

TEST(WebToken, IsReadFromAFileThatKeepsIt) {
  const test::TemporaryFolder folder;
  const auto read = [&folder](const std::string& text, std::filesystem::perms mode) {
    const auto path = folder.file("token", text);
    std::filesystem::permissions(path, mode);
    return read_token(path.string());
  };
  using std::filesystem::perms;
  const perms own = perms::owner_read | perms::owner_write;
  EXPECT_EQ(std::get<WebToken>(read("0123456789abcdef\n", own)).text, "0123456789abcdef");
  EXPECT_EQ(std::get<WebToken>(read("0123456789abcdef", own | perms::group_read)).text, "0123456789abcdef");
  EXPECT_NE(std::get<std::string>(read("0123456789abcdef", own | perms::others_read)).find("chmod o-r"),
            std::string::npos);
  for (const std::string& wrong : {std::string(), std::string("short\n"), std::string("two words of a token\n"),
                                   std::string("0123456789abcdef\n\n"), std::string(257, 'x')}) {
    EXPECT_TRUE(std::holds_alternative<std::string>(read(wrong, own))) << wrong;
  }
  EXPECT_TRUE(std::holds_alternative<std::string>(read_token((folder.path() / "missing").string())));
  EXPECT_TRUE(std::holds_alternative<std::string>(read_token(folder.path().string())));
}

TEST(WebCommands, ThePageMayLessThanTheSocket) {
  for (const char* const line : {"pause", "resume", "save", "pose 1 -2.5 90"}) {
    EXPECT_TRUE(page_may_ask(line)) << line;
  }
  for (const char* const line :
       {"stop", "reset", "status", "world", "localise", "map", "save /tmp/elsewhere", "save --force",
        "save --force /tmp/x", "tilt stop", "pose", "pose 1 2 nan", "pause\nstop", "pause\n", "", "pose 1 2 3\rstop"}) {
    EXPECT_FALSE(page_may_ask(line)) << line;
    EXPECT_TRUE(obey_page("/nonexistent/socket", line).starts_with("error: the page may ask for")) << line;
  }
  EXPECT_NE(obey_page("/nonexistent/socket", "pause").find("control.socket"), std::string::npos);
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
