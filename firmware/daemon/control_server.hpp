#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// Takes commands from programs on this machine: a line in, a text out, over a stream socket in the file system.
///
/// Whoever may write to the socket may command: its owner and group (mode 0660). Thread: supervisor.
class ControlServer {
 public:
  using Handler = std::function<std::string(std::string_view command)>;

  /// @return  0, or the errno for which there is no socket; EADDRINUSE: another daemon answers there.
  [[nodiscard]] int open(const std::string& path);
  ~ControlServer();
  ControlServer() = default;
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Readable when somebody wants something; -1 without a socket.
  [[nodiscard]] int descriptor() const { return listener_.get(); }

  /// Answers those who wait. Nobody holds it for longer than `kPatience_ms`.
  void serve(const Handler& handler);

  static constexpr int kPatience_ms = 100;
  static constexpr std::size_t kCommandMaxBytes = 1024;

 private:
  std::string path_;
  FileDescriptor listener_;
};

/// The other side: sends a command and returns the answer.
/// @return  0, or the errno of what failed.
[[nodiscard]] int send_command(const std::string& path, std::string_view command, std::string& answer);

}  // namespace odoless
