#include "firmware/daemon/control_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace odoless {
namespace {

constexpr int kQueue = 8;
constexpr int kAnswerWait_ms = 10'000;

bool set_path(sockaddr_un& address, const std::string& path) {
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return false;
  }
  std::copy(path.begin(), path.end(), address.sun_path);
  return true;
}

FileDescriptor connect_to(const sockaddr_un& address) {
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    socket.reset();
  }
  return socket;
}

bool is_readable(int descriptor, int timeout_ms) {
  pollfd ready{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&ready, 1, timeout_ms) > 0;
}

// Up to the end of the line or of the stream.
std::string read_line(int descriptor, int timeout_ms, std::size_t size_max_bytes) {
  std::string line;
  std::array<char, 512> piece{};
  while (line.size() < size_max_bytes && line.find('\n') == std::string::npos && is_readable(descriptor, timeout_ms)) {
    const ssize_t size_bytes = ::read(descriptor, piece.data(), piece.size());
    if (size_bytes <= 0) {
      break;
    }
    line.append(piece.data(), static_cast<std::size_t>(size_bytes));
  }
  return line.substr(0, line.find('\n'));
}

void write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::send(descriptor, text.data(), text.size(), MSG_NOSIGNAL);
    if (written <= 0) {
      return;
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

ControlServer::~ControlServer() {
  if (listener_.valid()) {
    static_cast<void>(::unlink(path_.c_str()));
  }
}

int ControlServer::open(const std::string& path) {
  sockaddr_un address{};
  if (!set_path(address, path)) {
    return ENAMETOOLONG;
  }
  if (connect_to(address).valid()) {
    return EADDRINUSE;
  }
  static_cast<void>(::unlink(path.c_str()));  // left by a daemon that was killed
  const std::string folder = path.substr(0, path.rfind('/'));
  static_cast<void>(::mkdir(folder.c_str(), 0755));  // where it cannot be made, bind says why
  FileDescriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      ::chmod(path.c_str(), 0660) != 0 || ::listen(listener.get(), kQueue) != 0) {
    return errno;
  }
  path_ = path;
  listener_ = std::move(listener);
  return 0;
}

void ControlServer::serve(const Handler& handler) {
  for (;;) {
    const FileDescriptor client(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!client.valid()) {
      return;
    }
    write_all(client.get(), handler(read_line(client.get(), kPatience_ms, kCommandMaxBytes)));
  }
}

int send_command(const std::string& path, std::string_view command, std::string& answer) {
  sockaddr_un address{};
  if (!set_path(address, path)) {
    return ENAMETOOLONG;
  }
  const FileDescriptor socket = connect_to(address);
  if (!socket.valid()) {
    return errno;
  }
  write_all(socket.get(), std::string(command) + "\n");
  answer.clear();
  std::array<char, 4096> piece{};
  while (is_readable(socket.get(), kAnswerWait_ms)) {
    const ssize_t size_bytes = ::read(socket.get(), piece.data(), piece.size());
    if (size_bytes <= 0) {
      return 0;
    }
    answer.append(piece.data(), static_cast<std::size_t>(size_bytes));
  }
  return ETIMEDOUT;
}

}  // namespace odoless
