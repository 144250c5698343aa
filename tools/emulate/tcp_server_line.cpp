#include "tools/emulate/tcp_server_line.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

bool is_waiting(ssize_t count) { return count < 0 && (errno == EAGAIN || errno == EINTR); }

}  // namespace

TcpServerLine::TcpServerLine(std::uint16_t port)
    : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const int on = 1;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size_bytes = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (!listener_.valid() || ::setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) != 0 ||
      ::bind(listener_.get(), generic, size_bytes) != 0 || ::listen(listener_.get(), 1) != 0 ||
      ::getsockname(listener_.get(), generic, &size_bytes) != 0) {
    throw CannotCreateError(fmt::format("port {} on 127.0.0.1: {}", port, system_reason(errno)));
  }
  port_ = ntohs(address.sin_port);
}

std::string TcpServerLine::path() const { return fmt::format("tcp://127.0.0.1:{}", port_); }

bool TcpServerLine::has_client() {
  char next = 0;
  if (client_.valid()) {
    const ssize_t count = ::recv(client_.get(), &next, 1, MSG_PEEK);
    if (count > 0 || is_waiting(count)) {
      return true;
    }
  }
  client_.reset(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  const int on = 1;
  return client_.valid() && ::setsockopt(client_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on)) == 0;
}

std::string TcpServerLine::read() {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::recv(client_.get(), bytes.data(), bytes.size(), 0);
  return {bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
}

std::size_t TcpServerLine::write(std::string_view bytes) {
  const ssize_t count = ::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace odoless
