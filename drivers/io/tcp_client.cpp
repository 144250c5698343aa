#include "drivers/io/tcp_client.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <memory>
#include <string>

namespace odoless {
namespace {

struct Option {
  int level;
  int name;
  int value;
};

constexpr Option kOptions[] = {{IPPROTO_TCP, TCP_NODELAY, 1},        {SOL_SOCKET, SO_KEEPALIVE, 1},
                               {IPPROTO_TCP, TCP_KEEPIDLE, 1},  // seconds
                               {IPPROTO_TCP, TCP_KEEPINTVL, 1},      {IPPROTO_TCP, TCP_KEEPCNT, 2},
                               {IPPROTO_TCP, TCP_USER_TIMEOUT, 2000}};  // milliseconds

Errc connect_error(int error_number) {
  switch (error_number) {
    case EACCES:
    case EPERM:
      return Errc::kDeviceDenied;
    case ECONNREFUSED:
    case ECONNRESET:
    case ETIMEDOUT:
    case EHOSTUNREACH:
    case EHOSTDOWN:
    case ENETUNREACH:
    case ENETDOWN:
    case EADDRNOTAVAIL:
      return Errc::kDeviceMissing;
    default:
      return Errc::kDeviceFailed;
  }
}

/// What became of a connection that was begun.
Errc await_connection(int descriptor, std::int64_t timeout_ns) {
  pollfd ready{.fd = descriptor, .events = POLLOUT, .revents = 0};
  const timespec timeout{.tv_sec = timeout_ns / 1'000'000'000, .tv_nsec = timeout_ns % 1'000'000'000};
  const int count = ::ppoll(&ready, 1, &timeout, nullptr);
  if (count <= 0) {
    return count == 0 || errno == EINTR ? Errc::kDeviceMissing : Errc::kDeviceFailed;
  }
  int error_number = 0;
  socklen_t size_bytes = sizeof(error_number);
  if (::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error_number, &size_bytes) != 0) {
    return Errc::kDeviceFailed;
  }
  return error_number == 0 ? Errc::kOk : connect_error(error_number);
}

}  // namespace

Result<FileDescriptor> open_tcp(const TcpAddress& address, std::int64_t timeout_ns) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found) != 0) {
    return Errc::kBadAddress;
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  FileDescriptor connection(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!connection.valid()) {
    return Errc::kDeviceFailed;
  }
  for (const Option& option : kOptions) {
    if (::setsockopt(connection.get(), option.level, option.name, &option.value, sizeof(option.value)) != 0) {
      return Errc::kDeviceFailed;
    }
  }
  if (::connect(connection.get(), found->ai_addr, found->ai_addrlen) != 0) {
    const Errc error = errno == EINPROGRESS ? await_connection(connection.get(), timeout_ns) : connect_error(errno);
    if (error != Errc::kOk) {
      return error;
    }
  }
  return connection;
}

}  // namespace odoless
