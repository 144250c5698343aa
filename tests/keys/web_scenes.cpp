#include <fmt/format.h>
#include <gtest/gtest.h>
#include <httplib.h>
#undef _res  // which resolv.h makes a macro of, and Eigen has as a name

#include "firmware/web/web_server.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/support/private_network.hpp"

namespace odoless::test {
namespace {

constexpr int kPort = 8080;

/// What a browser is answered that calls this host so; at first `meanwhile` once what it watches comes.
std::string asked(
    const char* path, const std::string& host, const std::function<void()>& meanwhile = [] {}) {
  httplib::Client browser("127.0.0.1", kPort);
  int status = 0;
  browser.Get(
      path, {{"Host", host}},
      [&](const httplib::Response& response) {
        status = response.status;
        return true;
      },
      [&](const char* /*data*/, std::size_t /*size*/) {
        meanwhile();
        return false;
      });
  return fmt::format("{} of {}: {}\n", path, host, status);
}

/// Two browsers that watch, and one that has a name for this host.
std::string browsed(const DaemonParams& params) {
  const LiveView view({.resolution_m = 0.1, .columns = 64, .rows = 64});
  WebServer server(params.web, view, [](std::string_view) { return std::string(); });
  if (const std::string wrong = server.open(); !wrong.empty()) {
    return wrong;
  }
  EXPECT_EQ(server.start(), 0);
  std::string text = asked("/", "robot.lan");
  std::string second;
  text += asked("/events", "127.0.0.1", [&second] { second = asked("/events", "127.0.0.1"); });
  return text + second;
}

std::vector<Scene> all_web_scenes() {
  return {{"browsed",
           {fmt::format("[web]\nlisten = \"127.0.0.1:{}\"\nname = \"robot.lan\"\nclients_max = 1\n", kPort)},
           browsed}};
}

}  // namespace

KeyClass web_class() { return {"web", {"web."}, all_web_scenes, enter_private_network}; }

}  // namespace odoless::test
