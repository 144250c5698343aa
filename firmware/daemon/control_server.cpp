#include "firmware/daemon/control_server.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace odoless {
namespace {

constexpr int kQueue = 16;
constexpr std::int64_t kDeaf_ns = 100'000'000;
constexpr int kAnswerWait_ms = 10'000;

bool set_path(sockaddr_un& address, const std::string& path) {
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return false;
  }
  std::copy(path.begin(), path.end(), address.sun_path);
  return true;
}

FileDescriptor make_socket(int flags) {
  return FileDescriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0));
}

// 0 or errno.
int connect_to(int socket, const sockaddr_un& address) {
  return ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ? 0 : errno;
}

ControlPeer peer_of(int socket) {
  ucred other{};
  socklen_t size_bytes = sizeof(other);
  const bool known = ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &other, &size_bytes) == 0;
  return known ? ControlPeer{other.pid, other.uid} : ControlPeer{0, static_cast<uid_t>(-1)};
}

std::string folder_of(const std::string& path) {
  const std::size_t end = path.rfind('/');
  return end == std::string::npos ? "." : path.substr(0, std::max<std::size_t>(end, 1));
}

// The inode of the socket at that path; 0: there is none, or something else.
ino_t socket_at(const std::string& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && S_ISSOCK(found.st_mode) ? found.st_ino : 0;
}

bool exists(const std::string& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0;
}

// No other daemon looks for its place in this folder meanwhile: between finding a dead socket and replacing it, another
// one could put a living one there. Let go when the descriptor is closed.
FileDescriptor lock_folder(const std::string& folder) {
  FileDescriptor locked(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  constexpr int kTries = 50;
  for (int i = 0; locked.valid() && ::flock(locked.get(), LOCK_EX | LOCK_NB) != 0 && i < kTries; ++i) {
    static_cast<void>(::poll(nullptr, 0, 2));
  }
  return locked;
}

bool is_readable(int descriptor, int timeout_ms) {
  pollfd ready{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&ready, 1, timeout_ms) > 0;
}

}  // namespace

ControlServer::~ControlServer() {
  if (listener_.valid() && socket_at(path_) == inode_) {
    static_cast<void>(::unlink(path_.c_str()));
  }
}

int ControlServer::open(const std::string& path) {
  sockaddr_un address{};
  if (!set_path(address, path)) {
    return ENAMETOOLONG;
  }
  const std::string folder = folder_of(path);
  static_cast<void>(::mkdir(folder.c_str(), 0755));  // where it cannot be made, bind says why
  const FileDescriptor lock = lock_folder(folder);
  if (exists(path) && socket_at(path) == 0) {
    return ENOTSOCK;
  }
  const FileDescriptor probe = make_socket(SOCK_NONBLOCK);
  const int error = connect_to(probe.get(), address);
  if (error == 0 || error == EAGAIN) {  // EAGAIN: it listens, and has a queue
    other_ = error == 0 ? peer_of(probe.get()).pid : 0;
    return EADDRINUSE;
  }
  if (error == ECONNREFUSED) {
    static_cast<void>(::unlink(path.c_str()));  // left by a daemon that was killed
  } else if (error != ENOENT) {
    return error;
  }
  return bind_to(path);
}

int ControlServer::bind_to(const std::string& path) {
  sockaddr_un address{};
  static_cast<void>(set_path(address, path));
  FileDescriptor listener = make_socket(SOCK_NONBLOCK);
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return errno;
  }
  path_ = path;
  inode_ = socket_at(path);
  listener_ = std::move(listener);
  events_.reset(::epoll_create1(EPOLL_CLOEXEC));
  if (::chmod(path.c_str(), 0660) != 0 || ::listen(listener_.get(), kQueue) != 0 || !events_.valid() ||
      !watch(listener_.get(), EPOLLIN, true)) {
    return errno;
  }
  return 0;
}

bool ControlServer::watch(int descriptor, std::uint32_t events, bool is_new) {
  epoll_event event{};
  event.events = events;
  return ::epoll_ctl(events_.get(), is_new ? EPOLL_CTL_ADD : EPOLL_CTL_MOD, descriptor, &event) == 0;
}

void ControlServer::serve(std::int64_t now_ns, const Handler& handler) {
  if (!events_.valid()) {
    return;
  }
  for (Connection& connection : connections_) {
    if (connection.socket.valid()) {
      work(connection, now_ns, handler);
    }
  }
  accept_all(now_ns, handler);
}

void ControlServer::accept_all(std::int64_t now_ns, const Handler& handler) {
  if (now_ns < deaf_until_ns_) {
    return;
  }
  if (deaf_until_ns_ != 0) {
    deaf_until_ns_ = 0;
    static_cast<void>(watch(listener_.get(), EPOLLIN, false));
  }
  for (int i = 0; i < kConnectionsMax; ++i) {
    FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.valid()) {
      take(std::move(socket), now_ns, handler);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return;
    } else if (errno != EINTR && errno != ECONNABORTED) {
      // No descriptors or memory: the caller stays waiting and would wake us without an end.
      deaf_until_ns_ = now_ns + kDeaf_ns;
      static_cast<void>(watch(listener_.get(), 0, false));
      return;
    }
  }
}

void ControlServer::take(FileDescriptor socket, std::int64_t now_ns, const Handler& handler) {
  // A free place is one whose time has never begun.
  Connection& place =
      *std::min_element(connections_.begin(), connections_.end(), [](const Connection& a, const Connection& b) {
        return (a.socket.valid() ? a.end_ns : INT64_MIN) < (b.socket.valid() ? b.end_ns : INT64_MIN);
      });
  place = {.socket = std::move(socket), .end_ns = now_ns + kPatience_ns};
  place.peer = peer_of(place.socket.get());
  if (watch(place.socket.get(), EPOLLIN, true)) {
    work(place, now_ns, handler);  // the line is mostly there already
  } else {
    place.socket.reset();
  }
}

void ControlServer::work(Connection& connection, std::int64_t now_ns, const Handler& handler) {
  if (!connection.answers) {
    hear(connection, now_ns, handler);
  }
  if (connection.answers) {
    send(connection);
  }
  if (connection.socket.valid() && now_ns >= connection.end_ns) {
    if (connection.answers) {
      connection.socket.reset();  // it does not take its answer
    } else {
      answer(connection, now_ns, "error: a command is one line, within a second\n");
      send(connection);
      connection.socket.reset();
    }
  }
}

void ControlServer::hear(Connection& connection, std::int64_t now_ns, const Handler& handler) {
  std::array<char, kCommandMaxBytes + 1> piece{};
  const std::size_t room_bytes = piece.size() - connection.heard.size();
  const ssize_t size_bytes = ::read(connection.socket.get(), piece.data(), room_bytes);
  if (size_bytes < 0) {
    if (errno != EAGAIN && errno != EINTR) {
      connection.socket.reset();
    }
    return;
  }
  connection.heard.append(piece.data(), static_cast<std::size_t>(size_bytes));
  const std::size_t end = connection.heard.find('\n');
  if (end != std::string::npos || (size_bytes == 0 && !connection.heard.empty())) {
    const std::string command = connection.heard.substr(0, end);
    answer(connection, now_ns, handler(command, connection.peer));
  } else if (size_bytes == 0) {
    connection.socket.reset();
  } else if (connection.heard.size() > kCommandMaxBytes) {
    answer(connection, now_ns, fmt::format("error: a command has at most {} bytes\n", kCommandMaxBytes));
  }
}

void ControlServer::answer(Connection& connection, std::int64_t now_ns, std::string text) {
  connection.answer = std::move(text);
  connection.answers = true;
  connection.heard = {};
  connection.end_ns = now_ns + kPatience_ns;
  static_cast<void>(watch(connection.socket.get(), EPOLLOUT, false));
}

void ControlServer::send(Connection& connection) {
  const ssize_t sent =
      ::send(connection.socket.get(), connection.answer.data(), connection.answer.size(), MSG_NOSIGNAL);
  if (sent >= 0) {
    connection.answer.erase(0, static_cast<std::size_t>(sent));
  }
  const bool waits = sent >= 0 ? !connection.answer.empty() : errno == EAGAIN || errno == EINTR;
  if (!waits) {
    connection.socket.reset();
    connection.answer = {};
  }
}

int send_command(const std::string& path, std::string_view command, std::string& answer) {
  sockaddr_un address{};
  if (!set_path(address, path)) {
    return ENAMETOOLONG;
  }
  const FileDescriptor socket = make_socket(0);
  if (const int error = connect_to(socket.get(), address); error != 0) {
    return error;
  }
  const std::string line = std::string(command) + "\n";
  if (::send(socket.get(), line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size())) {
    return errno;
  }
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
