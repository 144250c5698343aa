#include "firmware/daemon/control_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

/// A server that answers on a thread of its own, as the supervisor does.
class ControlServerTest : public ::testing::Test {
 protected:
  void serve(int rounds) {
    thread_ = std::thread([this, rounds] {
      for (int round = 0; round < rounds; ++round) {
        pollfd ready{.fd = server_.descriptor(), .events = POLLIN, .revents = 0};
        static_cast<void>(::poll(&ready, 1, 5000));
        server_.serve([](std::string_view command) { return "heard " + std::string(command) + "\n"; });
      }
    });
  }
  ~ControlServerTest() override {
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  test::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "run" / "control").string();
  ControlServer server_;
  std::thread thread_;
};

FileDescriptor connect_to(const std::string& path) {
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  return socket;
}

TEST_F(ControlServerTest, AnswersACommandAndMakesItsFolder) {
  ASSERT_EQ(server_.open(path_), 0);
  serve(1);
  std::string answer;
  EXPECT_EQ(send_command(path_, "status", answer), 0);
  EXPECT_EQ(answer, "heard status\n");
}

TEST_F(ControlServerTest, OnlyOwnerAndGroupMayCommand) {
  ASSERT_EQ(server_.open(path_), 0);
  struct stat status {};
  ASSERT_EQ(::stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
}

TEST_F(ControlServerTest, ASecondServerIsRefusedAndASocketLeftBehindIsNot) {
  ASSERT_EQ(server_.open(path_), 0);
  ControlServer second;
  EXPECT_EQ(second.open(path_), EADDRINUSE);
  const std::string left = (folder_.path() / "left").string();
  FileDescriptor killed(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  left.copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(killed.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  killed.reset();
  EXPECT_EQ(second.open(left), 0);
}

TEST_F(ControlServerTest, AClientThatSaysNothingHoldsNobodyUp) {
  ASSERT_EQ(server_.open(path_), 0);
  std::chrono::duration<double, std::milli> least = std::chrono::hours(1);
  for (int i = 0; i < 3; ++i) {  // what else the machine does only ever adds to it
    const FileDescriptor silent = connect_to(path_);
    const auto begin = std::chrono::steady_clock::now();
    server_.serve([](std::string_view command) { return std::string(command); });
    least = std::min<std::chrono::duration<double, std::milli>>(least, std::chrono::steady_clock::now() - begin);
  }
  EXPECT_LT(least.count(), 10 * ControlServer::kPatience_ms);
}

TEST_F(ControlServerTest, AnEndlessCommandIsCut) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor client = connect_to(path_);
  const std::string endless(100'000, 'x');
  ASSERT_GT(::send(client.get(), endless.data(), endless.size(), MSG_DONTWAIT | MSG_NOSIGNAL), 0);
  std::size_t heard = 0;
  server_.serve([&heard](std::string_view command) {
    heard = command.size();
    return std::string();
  });
  EXPECT_LE(heard, ControlServer::kCommandMaxBytes + 512);
}

TEST_F(ControlServerTest, SaysWhyThereIsNoSocket) {
  EXPECT_EQ(server_.open(std::string(200, 'a')), ENAMETOOLONG);
  EXPECT_EQ(server_.open("/proc/none/control"), ENOENT);
  std::string answer;
  EXPECT_EQ(send_command(path_, "status", answer), ENOENT);
}

}  // namespace
}  // namespace odoless
