#include "firmware/daemon/control_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

/// A server, its clients and the time, all in this thread's hands.
class ControlServerTest : public ::testing::Test {
 protected:
  /// What a supervisor does in a round.
  void serve(std::int64_t passes_ns = 20 * kMs) {
    now_ns_ += passes_ns;
    server_.serve(now_ns_, [this](std::string_view command, const ControlPeer& peer) {
      ++obeyed_;
      peer_ = peer;
      return "heard " + std::string(command) + "\n";
    });
  }
  [[nodiscard]] bool is_wanted() const {
    pollfd ready{.fd = server_.descriptor(), .events = POLLIN, .revents = 0};
    return ::poll(&ready, 1, 0) > 0;
  }

  test::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "run" / "control").string();
  ControlServer server_;
  ControlPeer peer_;
  int obeyed_ = 0;
  std::int64_t now_ns_ = 0;
};

FileDescriptor connect_to(const std::string& path) {
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  return socket;
}

void say(const FileDescriptor& client, std::string_view text) {
  ASSERT_EQ(::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}

/// What has come until now.
std::string heard_by(const FileDescriptor& client) {
  std::string all;
  std::array<char, 4096> piece{};
  for (ssize_t size = 1; size > 0; all.append(piece.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)))) {
    size = ::recv(client.get(), piece.data(), piece.size(), MSG_DONTWAIT);
  }
  return all;
}

bool is_closed(const FileDescriptor& client) {
  char byte = 0;
  return ::recv(client.get(), &byte, 1, MSG_DONTWAIT) == 0 || errno != EAGAIN;
}

TEST_F(ControlServerTest, AnswersACommandAndMakesItsFolder) {
  ASSERT_EQ(server_.open(path_), 0);
  std::atomic<bool> answered = false;
  std::thread client([&] {
    std::string answer;
    EXPECT_EQ(send_command(path_, "status", answer), 0);
    EXPECT_EQ(answer, "heard status\n");
    answered = true;
  });
  while (!answered) {
    pollfd ready{.fd = server_.descriptor(), .events = POLLIN, .revents = 0};
    static_cast<void>(::poll(&ready, 1, 20));
    serve(0);
  }
  client.join();
}

TEST_F(ControlServerTest, KnowsWhoCommands) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor client = connect_to(path_);
  say(client, "stop\n");
  serve();
  EXPECT_EQ(peer_.pid, ::getpid());
  EXPECT_EQ(peer_.uid, ::getuid());
}

TEST_F(ControlServerTest, IsWantedWhenThereIsSomethingToDoAndNotOtherwise) {
  ASSERT_EQ(server_.open(path_), 0);
  EXPECT_FALSE(is_wanted());
  const FileDescriptor client = connect_to(path_);
  EXPECT_TRUE(is_wanted());
  serve();
  EXPECT_FALSE(is_wanted()) << "a silent client would keep the supervisor busy";
  say(client, "status\n");
  EXPECT_TRUE(is_wanted());
  serve();
  EXPECT_FALSE(is_wanted());
  EXPECT_EQ(heard_by(client), "heard status\n");
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
  EXPECT_EQ(second.other(), ::getpid());
  const std::string left = (folder_.path() / "left").string();
  FileDescriptor killed(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  left.copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(killed.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  killed.reset();
  EXPECT_EQ(second.open(left), 0);
}

TEST_F(ControlServerTest, LeavesAloneWhatIsNoSocket) {
  const std::filesystem::path file = folder_.path() / "precious";
  std::ofstream(file) << "data";
  EXPECT_EQ(server_.open(file.string()), ENOTSOCK);
  const std::filesystem::path link = folder_.path() / "link";
  std::filesystem::create_symlink("nowhere", link);
  EXPECT_EQ(server_.open(link.string()), ENOTSOCK);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  std::filesystem::create_directory(folder_.path() / "folder");
  EXPECT_EQ(server_.open((folder_.path() / "folder").string()), ENOTSOCK);
  std::string content;
  std::ifstream(file) >> content;
  EXPECT_EQ(content, "data");
}

TEST_F(ControlServerTest, LeavesAloneWhatHasTakenItsPlace) {
  {
    ControlServer server;
    ASSERT_EQ(server.open(path_), 0);
    ASSERT_EQ(::unlink(path_.c_str()), 0);
    std::ofstream(path_) << "data";
  }
  EXPECT_TRUE(std::filesystem::is_regular_file(path_));
}

TEST_F(ControlServerTest, APathWithoutAFolderIsNoFolder) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  EXPECT_EQ(server_.open("control"), 0);
  EXPECT_TRUE(std::filesystem::is_socket("control"));
  std::filesystem::current_path(before);
}

TEST_F(ControlServerTest, AClientThatSaysLittleOrNothingHoldsNobodyUp) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor silent = connect_to(path_);
  const FileDescriptor slow = connect_to(path_);
  for (int i = 0; i < 100; ++i) {
    if (i % 4 == 0) {
      static_cast<void>(::send(slow.get(), "x", 1, MSG_NOSIGNAL));  // a byte every 80 ms
    }
    const FileDescriptor quick = connect_to(path_);
    say(quick, "status\n");
    const auto begin = std::chrono::steady_clock::now();
    serve();
    EXPECT_EQ(heard_by(quick), "heard status\n") << i;
    if (i < 45) {  // until their time is over, nobody waits for them
      EXPECT_FALSE(is_closed(silent));
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1)) << "it has waited for a client";
  }
  EXPECT_EQ(obeyed_, 100);
  EXPECT_EQ(heard_by(slow), "error: a command is one line, within a second\n");
  EXPECT_TRUE(is_closed(slow));
  static_cast<void>(heard_by(silent));
  EXPECT_TRUE(is_closed(silent));
}

TEST_F(ControlServerTest, ANewcomerIsServedHoweverManySitThere) {
  ASSERT_EQ(server_.open(path_), 0);
  std::vector<FileDescriptor> sitting;
  for (int i = 0; i < 5 * ControlServer::kConnectionsMax; ++i) {
    sitting.push_back(connect_to(path_));
    serve(0);
    const FileDescriptor client = connect_to(path_);
    say(client, "status\n");
    serve(0);
    ASSERT_EQ(heard_by(client), "heard status\n") << i;
  }
  const auto open =
      std::count_if(sitting.begin(), sitting.end(), [](const FileDescriptor& one) { return !is_closed(one); });
  EXPECT_LE(open, ControlServer::kConnectionsMax);
  EXPECT_GE(open, ControlServer::kConnectionsMax - 1);
}

TEST_F(ControlServerTest, AClientThatDoesNotTakeItsAnswerIsLeft) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor client = connect_to(path_);
  say(client, "status\n");
  const std::string long_answer(std::size_t{4} << 20, 'a');
  server_.serve(0, [&](std::string_view, const ControlPeer&) { return long_answer; });
  EXPECT_FALSE(is_wanted()) << "its line is full";
  server_.serve(ControlServer::kPatience_ns + 1, [&](std::string_view, const ControlPeer&) { return long_answer; });
  const std::string heard = heard_by(client);
  EXPECT_GT(heard.size(), 0U);
  EXPECT_LT(heard.size(), long_answer.size());
  EXPECT_TRUE(is_closed(client));
}

TEST_F(ControlServerTest, ALongAnswerArrivesWhole) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor client = connect_to(path_);
  say(client, "status\n");
  const std::string long_answer(std::size_t{4} << 20, 'a');
  std::size_t heard_bytes = 0;
  for (int i = 0; i < 1000 && heard_bytes < long_answer.size(); ++i) {
    server_.serve(0, [&](std::string_view, const ControlPeer&) { return long_answer; });
    heard_bytes += heard_by(client).size();
  }
  EXPECT_EQ(heard_bytes, long_answer.size());
}

TEST_F(ControlServerTest, AnEndlessCommandIsRefusedAndNotObeyed) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor client = connect_to(path_);
  const std::string endless(100'000, 'x');
  ASSERT_GT(::send(client.get(), endless.data(), endless.size(), MSG_DONTWAIT | MSG_NOSIGNAL), 0);
  serve();
  serve();
  EXPECT_EQ(obeyed_, 0);
  EXPECT_EQ(heard_by(client), "error: a command has at most 1024 bytes\n");
}

TEST_F(ControlServerTest, TakesALineThatEndsWithTheStream) {
  ASSERT_EQ(server_.open(path_), 0);
  const FileDescriptor client = connect_to(path_);
  say(client, "sta");
  serve();
  say(client, "tus");
  ASSERT_EQ(::shutdown(client.get(), SHUT_WR), 0);
  serve();
  serve();
  EXPECT_EQ(heard_by(client), "heard status\n");
}

TEST_F(ControlServerTest, HostileBytesOfManyClientsLeaveItAlive) {
  ASSERT_EQ(server_.open(path_), 0);
  Rng rng(5);
  std::vector<FileDescriptor> clients(8);
  for (int i = 0; i < 4000; ++i) {
    FileDescriptor& client = clients[rng.below(8)];
    if (!client.valid() || is_closed(client)) {
      client = connect_to(path_);
    }
    std::string bytes(rng.below(1500), '\0');
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(rng.below(256)); });
    static_cast<void>(::send(client.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
    if (rng.below(4) == 0) {
      client.reset();
    }
    serve(static_cast<std::int64_t>(rng.below(50)) * kMs);
  }
  const FileDescriptor client = connect_to(path_);
  say(client, "status\n");
  serve();
  EXPECT_EQ(heard_by(client), "heard status\n");
}

TEST_F(ControlServerTest, SaysWhyThereIsNoSocket) {
  EXPECT_EQ(server_.open(std::string(200, 'a')), ENAMETOOLONG);
  EXPECT_EQ(server_.open("/proc/none/control"), ENOENT);
  std::string answer;
  EXPECT_EQ(send_command(path_, "status", answer), ENOENT);
}

}  // namespace
}  // namespace odoless
