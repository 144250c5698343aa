#include "drivers/io/udp_listener.hpp"

#include <linux/filter.h>
#include <netdb.h>
#include <sys/socket.h>

#include <cerrno>
#include <iterator>
#include <memory>
#include <string>

namespace odoless {
namespace {

constexpr unsigned kUdpHeaderBytes = 8;
constexpr unsigned kWhole = 0xFFFFFFFF;

/// Lets datagrams through that hold something.
bool refuse_empty(int descriptor) {
  sock_filter steps[] = {{BPF_LD | BPF_W | BPF_LEN, 0, 0, 0},
                         {BPF_JMP | BPF_JGT | BPF_K, 0, 1, kUdpHeaderBytes},
                         {BPF_RET | BPF_K, 0, 0, kWhole},
                         {BPF_RET | BPF_K, 0, 0, 0}};
  const sock_fprog program{.len = std::size(steps), .filter = steps};
  return ::setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)) == 0;
}

Errc bind_error(int error_number) {
  switch (error_number) {
    case EADDRINUSE:
      return Errc::kDeviceBusy;
    case EADDRNOTAVAIL:
      return Errc::kDeviceMissing;
    case EACCES:
      return Errc::kDeviceDenied;
    default:
      return Errc::kDeviceFailed;
  }
}

}  // namespace

Result<FileDescriptor> open_udp(const UdpAddress& address) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found) != 0) {
    return Errc::kBadAddress;
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  FileDescriptor listener(::socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!listener.valid() || !refuse_empty(listener.get())) {
    return Errc::kDeviceFailed;
  }
  if (::bind(listener.get(), found->ai_addr, found->ai_addrlen) != 0) {
    return bind_error(errno);
  }
  return listener;
}

}  // namespace odoless
