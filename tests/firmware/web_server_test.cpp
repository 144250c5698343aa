#include "firmware/web/web_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <thread>
#include <vector>

#include "drivers/io/file_descriptor.hpp"
#include "firmware/threads/round.hpp"
#include "firmware/threads/tile_sweep.hpp"
#include "rt/cpu_clock.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

constexpr int kSide_cells = TileSweep::kSide_cells;

/// A port that nobody has, most likely.
int free_port() {
  const FileDescriptor probe(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size_bytes = sizeof(address);
  EXPECT_EQ(::bind(probe.get(), reinterpret_cast<const sockaddr*>(&address), size_bytes), 0);
  EXPECT_EQ(::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&address), &size_bytes), 0);
  return ntohs(address.sin_port);
}

WebParams params_of(int port) {
  WebParams params;
  params.listen = "127.0.0.1:" + std::to_string(port);
  return params;
}

class WebServerTest : public ::testing::Test {
 protected:
  void publish(int i) {
    PoseRecord pose;
    pose.stamp_ns = i;
    pose.map_T_scan.x_m = 0.1 * i;
    view_.take(pose);
    view_.take({.column = i % 4 - 2, .row = 0, .size_cells = kSide_cells, .cell_size_m = 0.05},
               std::vector<std::uint8_t>(std::size_t{kSide_cells} * kSide_cells, static_cast<std::uint8_t>(i % 100)));
    view_.take(DaemonStatus{});
  }

  LiveView view_{{.resolution_m = 0.05, .columns = 4 * kSide_cells, .rows = 4 * kSide_cells}};
  int port_ = free_port();
};

TEST_F(WebServerTest, ServesThePageAndItsEvents) {
  publish(1);
  WebServer server(params_of(port_), view_);
  ASSERT_EQ(server.open(), "");
  ASSERT_EQ(server.start(), 0);
  httplib::Client client("127.0.0.1", port_);
  const httplib::Result page = client.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, HasSubstr("page.js"));
  std::string events;
  client.Get("/events", [&events](const char* data, std::size_t size_bytes) {
    events.append(data, size_bytes);
    return events.find("event: tile") == std::string::npos;  // then it has had enough
  });
  EXPECT_THAT(events, HasSubstr("\"x_m\":0.100"));
}

TEST_F(WebServerTest, StartsAndEndsAgainAndAgainWhileBrowsersComeAndGo) {
  std::atomic<bool> over = false;
  std::thread publisher([&] {
    for (int i = 0; !over; ++i) {
      publish(i);
      sleep_ns(1'000'000);
    }
  });
  std::atomic<int> served = 0;
  std::vector<std::thread> browsers;
  for (int i = 0; i < 6; ++i) {
    browsers.emplace_back([&] {
      while (!over) {
        int pieces = 0;
        httplib::Client client("127.0.0.1", port_);
        client.Get("/events", [&](const char*, std::size_t) { return ++pieces < 3 && !over; });
        served += pieces > 0 ? 1 : 0;
      }
    });
  }
  for (int i = 0; i < 10; ++i) {
    WebServer server(params_of(port_), view_);
    ASSERT_EQ(server.open(), "");
    ASSERT_EQ(server.start(), 0);
    sleep_ns(200'000'000);
  }
  over = true;
  publisher.join();
  for (std::thread& browser : browsers) {
    browser.join();
  }
  EXPECT_GT(served, 10);
}

TEST_F(WebServerTest, CommandsOfWhoKnowsTheTokenAreHandedOnAndNoOthers) {
  const test::TemporaryFolder folder;
  WebParams params = params_of(port_);
  params.token_file = folder.file("token", "0123456789abcdef\n").string();
  std::filesystem::permissions(params.token_file, std::filesystem::perms::owner_read);
  std::string heard;
  WebServer server(params, view_, [&heard](std::string_view line) {
    heard += line;
    return std::string("ok\n");
  });
  ASSERT_EQ(server.open(), "");
  ASSERT_EQ(server.start(), 0);
  httplib::Client client("127.0.0.1", port_);
  const auto post = [&client](const httplib::Headers& headers, const std::string& body) {
    const httplib::Result result = client.Post("/command", headers, body, "text/plain");
    return result ? result->status : -1;
  };
  EXPECT_EQ(post({}, "pause"), 401);
  EXPECT_EQ(post({{"Authorization", "Bearer 0123456789abcdeg"}}, "pause"), 401);
  const std::pair<std::string, std::string> right{"Authorization", "Bearer 0123456789abcdef"};
  EXPECT_EQ(post({right, {"Origin", "http://evil.example"}}, "pause"), 403);
  EXPECT_EQ(post({right}, std::string(1000, 'x')), 413);
  EXPECT_EQ(heard, "");
  EXPECT_EQ(post({right}, "pause"), 200);
  EXPECT_EQ(heard, "pause");
  EXPECT_EQ(client.Get("/control")->body, "yes");
}

TEST_F(WebServerTest, WithoutATokenItIsReadOnly) {
  WebServer server(params_of(port_), view_, [](std::string_view) -> std::string {
    ADD_FAILURE() << "commanded";
    return "";
  });
  ASSERT_EQ(server.open(), "");
  ASSERT_EQ(server.start(), 0);
  httplib::Client client("127.0.0.1", port_);
  EXPECT_EQ(client.Post("/command", {{"Authorization", "Bearer "}}, "pause", "text/plain")->status, 403);
  EXPECT_EQ(client.Get("/control")->body, "no");
}

TEST_F(WebServerTest, SaysWhatIsWrongWithItsToken) {
  WebParams params = params_of(port_);
  params.token_file = "/nonexistent/token";
  EXPECT_THAT(WebServer(params, view_, [](std::string_view) { return std::string(); }).open(),
              HasSubstr("web.token_file: /nonexistent/token"));
}

TEST_F(WebServerTest, OneThatNobodyStartedLeavesItsAddressToo) {
  for (int i = 0; i < 3; ++i) {
    WebServer server(params_of(port_), view_);
    EXPECT_EQ(server.open(), "");
  }
}

TEST_F(WebServerTest, SaysWhatIsWrongWithItsAddress) {
  WebServer first(params_of(port_), view_);
  ASSERT_EQ(first.open(), "");
  WebServer second(params_of(port_), view_);
  EXPECT_THAT(second.open(), HasSubstr("in use"));
  for (const char* const wrong : {"8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x", ":8080", "127.0.0.1:70000"}) {
    WebParams params;
    params.listen = wrong;
    EXPECT_THAT(params.contradiction(), HasSubstr("127.0.0.1:8080")) << wrong;
  }
  WebParams params;
  EXPECT_EQ(params.contradiction(), "");
  params.listen = "[::1]:8080";
  EXPECT_EQ(params.address()->host, "::1");
}

}  // namespace
}  // namespace odoless
