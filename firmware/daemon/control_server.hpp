#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// Who sends a command, as the kernel says (SO_PEERCRED).
struct ControlPeer {
  pid_t pid = 0;
  uid_t uid = 0;
};

/// Takes commands from programs on this machine: a line in, a text out, over a stream socket in the file system.
///
/// Whoever may write to the socket may command: its owner and group (mode 0660). Several connections are served side by
/// side, and none is waited for: each has `kPatience_ns` for its line and as long again to take the answer. A newcomer
/// always finds a place: where all are taken, the connection that has had its place longest gives it up. Memory:
/// `kConnectionsMax` commands of `kCommandMaxBytes` and their answers.
///
/// Thread: supervisor.
class ControlServer {
 public:
  using Handler = std::function<std::string(std::string_view command, const ControlPeer& peer)>;

  /// Makes the socket, and its folder where that is missing. A socket that a dead daemon left is replaced; anything
  /// else at that path is left alone.
  /// @return  0, or the errno for which there is no socket. EADDRINUSE: a program listens there (`other`); ENOTSOCK: at
  ///          the path is something that is no socket.
  [[nodiscard]] int open(const std::string& path);
  ~ControlServer();
  ControlServer() = default;
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// After EADDRINUSE: the process that listens there; 0: not known.
  [[nodiscard]] pid_t other() const { return other_; }

  /// Readable when somebody wants something; -1 without a socket.
  [[nodiscard]] int descriptor() const { return events_.get(); }

  /// Does what can be done at once, and closes what is over its time. To be called when `descriptor` is readable, and
  /// every few milliseconds.
  void serve(std::int64_t now_ns, const Handler& handler);

  static constexpr std::int64_t kPatience_ns = 1'000'000'000;
  static constexpr std::size_t kCommandMaxBytes = 1024;
  static constexpr int kConnectionsMax = 16;

 private:
  struct Connection {
    FileDescriptor socket{};
    ControlPeer peer{};
    std::int64_t end_ns = 0;
    std::string heard{};
    std::string answer{};
    bool answers = false;  ///< the command is obeyed; `answer` is what has still to be sent
  };

  [[nodiscard]] int bind_to(const std::string& path);
  [[nodiscard]] bool watch(int descriptor, std::uint32_t events, bool is_new);
  void accept_all(std::int64_t now_ns, const Handler& handler);
  void take(FileDescriptor socket, std::int64_t now_ns, const Handler& handler);
  void work(Connection& connection, std::int64_t now_ns, const Handler& handler);
  void hear(Connection& connection, std::int64_t now_ns, const Handler& handler);
  void answer(Connection& connection, std::int64_t now_ns, std::string text);
  static void send(Connection& connection);

  std::string path_;
  ino_t inode_ = 0;  ///< of the socket at `path_`
  FileDescriptor listener_;
  FileDescriptor events_;
  std::array<Connection, kConnectionsMax> connections_;
  std::int64_t deaf_until_ns_ = 0;  ///< the system could not give a connection
  pid_t other_ = 0;
};

/// The other side: sends a command and returns the answer.
/// @return  0, or the errno of what failed.
[[nodiscard]] int send_command(const std::string& path, std::string_view command, std::string& answer);

}  // namespace odoless
