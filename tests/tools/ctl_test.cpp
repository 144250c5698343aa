// Commands to a daemon, against a stand-in that answers as it is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "firmware/daemon/control_server.hpp"
#include "rt/cpu_clock.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Takes commands, and gives these answers one after the other.
class StandIn {
 public:
  explicit StandIn(std::deque<std::string> answers) : answers_(std::move(answers)) {
    EXPECT_EQ(server_.open(path()), 0);
    thread_ = std::thread([this] {
      while (!ends_) {
        server_.serve(monotonic_ns(), [this](std::string_view line, const ControlPeer&) {
          heard_.emplace_back(line);
          const std::string answer = answers_.empty() ? "error: no more is known\n" : answers_.front();
          answers_.pop_front();
          return answer;
        });
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  ~StandIn() { static_cast<void>(heard()); }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  [[nodiscard]] std::string path() const { return (folder_.path() / "control").string(); }
  /// Ends. @return  What it was told.
  std::vector<std::string> heard() {
    ends_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
    return heard_;
  }

 private:
  test::TemporaryFolder folder_;
  ControlServer server_;
  std::deque<std::string> answers_;
  std::vector<std::string> heard_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

std::string world(const std::string& mode, bool is_going_over, const std::string& error = "",
                  const std::string& refused = "") {
  return R"({"mode": ")" + mode + R"(", "going_over": )" + (is_going_over ? "true" : "false") + R"(, "error": ")" +
         error + R"(", "refused": ")" + refused + "\"}\n";
}

TEST(Command, CtlAsksOfTheWorld) {
  StandIn daemon({"mode: continue\n", world("continue", false)});
  EXPECT_EQ(run({"ctl", "--socket", daemon.path(), "world"}).out, "mode: continue\n");
  EXPECT_EQ(run({"ctl", "--socket", daemon.path(), "--json", "world"}).out, world("continue", false));
  EXPECT_THAT(daemon.heard(), ElementsAre("world", "world json"));
}

TEST(Command, CtlWaitsUntilTheDaemonHasGoneOver) {
  StandIn daemon({"ok: going over\n", world("continue", true), world("continue", true), world("localise", false),
                  "mode: localise\n"});
  const Outcome localise = run({"ctl", "--socket", daemon.path(), "localise"});
  EXPECT_EQ(localise.status, 0) << localise.err;
  EXPECT_EQ(localise.out, "mode: localise\n");
  EXPECT_THAT(daemon.heard(), ElementsAre("localise", "world json", "world json", "world json", "world"));
}

TEST(Command, CtlSaysWhyMappingDoesNotGoOn) {
  StandIn replaced({"ok: going over\n", world("localise", true), world("localise", false, "", "it was replaced")});
  const Outcome map = run({"ctl", "--socket", replaced.path(), "map"});
  EXPECT_EQ(map.status, 65);
  EXPECT_THAT(map.err, HasSubstr("mapping does not go on: it was replaced"));
  StandIn full({"error: the map is full\n"});
  const Outcome refused = run({"ctl", "--socket", full.path(), "map"});
  EXPECT_EQ(refused.status, 65);
  EXPECT_THAT(refused.err, HasSubstr("the map is full"));
}

TEST(Command, CtlDoesNotWaitForADiskThatIsFull) {
  StandIn daemon({"ok: going over\n", world("continue", true, "no space left on device")});
  const Outcome localise = run({"ctl", "--socket", daemon.path(), "localise"});
  EXPECT_EQ(localise.status, 73);
  EXPECT_THAT(localise.err, HasSubstr("no space left on device"));
}

TEST(Command, CtlWatchesAndGivesJsonOfWhatItAsksAlone) {
  for (const char* const option : {"--json", "--watch"}) {
    const Outcome outcome = run({"ctl", "--socket", "/nowhere", option, "localise"});
    EXPECT_EQ(outcome.status, 64);
    EXPECT_THAT(outcome.err, HasSubstr("go with the commands status and world alone"));
  }
}

}  // namespace
}  // namespace odoless
