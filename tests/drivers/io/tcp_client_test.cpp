#include "drivers/io/tcp_client.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <string>

#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

/// A device that listens on this machine.
struct Listener {
  explicit Listener(int backlog = 1) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size_bytes = sizeof(address);
    EXPECT_EQ(::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), size_bytes), 0);
    EXPECT_EQ(::listen(socket.get(), backlog), 0);
    EXPECT_EQ(::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size_bytes), 0);
    port = ntohs(address.sin_port);
  }
  FileDescriptor socket{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  std::uint16_t port = 0;
};

int option(const FileDescriptor& socket, int level, int name) {
  int value = -1;
  socklen_t size_bytes = sizeof(value);
  EXPECT_EQ(::getsockopt(socket.get(), level, name, &value, &size_bytes), 0);
  return value;
}

TEST(TcpClient, CarriesBytesBothWaysAndDoesNotBlock) {
  const Listener device;
  Result<FileDescriptor> opened = open_tcp({.host = "127.0.0.1", .port = device.port});
  ASSERT_TRUE(opened.ok()) << describe(opened.error());
  const FileDescriptor line = opened.take();
  const FileDescriptor far(::accept(device.socket.get(), nullptr, nullptr));
  std::array<char, 4> bytes{};
  EXPECT_EQ(::read(line.get(), bytes.data(), bytes.size()), -1);
  EXPECT_EQ(errno, EAGAIN);
  EXPECT_EQ(::write(line.get(), "QT\n", 3), 3);
  EXPECT_EQ(::read(far.get(), bytes.data(), bytes.size()), 3);
  EXPECT_EQ(::write(far.get(), "00P\n", 4), 4);
  pollfd ready{.fd = line.get(), .events = POLLIN, .revents = 0};
  EXPECT_EQ(::poll(&ready, 1, 1000), 1);
  EXPECT_EQ(::read(line.get(), bytes.data(), bytes.size()), 4);
  EXPECT_EQ(std::string(bytes.data(), 4), "00P\n");
}

TEST(TcpClient, SendsAtOnceAndNoticesASideThatIsGone) {
  const Listener device;
  Result<FileDescriptor> opened = open_tcp({.host = "127.0.0.1", .port = device.port});
  ASSERT_TRUE(opened.ok());
  EXPECT_EQ(option(opened.value(), IPPROTO_TCP, TCP_NODELAY), 1);
  EXPECT_EQ(option(opened.value(), SOL_SOCKET, SO_KEEPALIVE), 1);
  EXPECT_LE(option(opened.value(), IPPROTO_TCP, TCP_KEEPIDLE) +
                option(opened.value(), IPPROTO_TCP, TCP_KEEPINTVL) * option(opened.value(), IPPROTO_TCP, TCP_KEEPCNT),
            3);
  EXPECT_EQ(option(opened.value(), IPPROTO_TCP, TCP_USER_TIMEOUT), 2000);
  EXPECT_NE(::fcntl(opened.value().get(), F_GETFD) & FD_CLOEXEC, 0);
}

TEST(TcpClient, SaysThatNobodyListens) {
  std::uint16_t port = 0;
  {
    const Listener gone;
    port = gone.port;
  }
  EXPECT_EQ(open_tcp({.host = "127.0.0.1", .port = port}).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_tcp({.host = "laser.example", .port = 1}).error(), Errc::kBadAddress);
}

// To look a name up may take long, and is others' work (io/name_lookup).
TEST(TcpClient, LooksNoNameUpEvenWhereItIsKnown) {
  const Listener device;
  EXPECT_EQ(open_tcp({.host = "localhost", .port = device.port}).error(), Errc::kBadAddress);
}

TEST(TcpClient, DoesNotWaitLongForASideThatDoesNotAnswer) {
  const Listener full(0);  // on Linux, a queue of 0 takes one connection, and leaves the next without an answer
  const Result<FileDescriptor> first = open_tcp({.host = "127.0.0.1", .port = full.port});
  ASSERT_TRUE(first.ok());
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 3; ++i) {  // what else the machine does only ever adds to it
    const std::int64_t start_ns = monotonic_ns();
    EXPECT_EQ(open_tcp({.host = "127.0.0.1", .port = full.port}, 100'000'000).error(), Errc::kDeviceMissing);
    least_ns = std::min(least_ns, monotonic_ns() - start_ns);
  }
  EXPECT_GE(least_ns, 100'000'000);
  EXPECT_LT(least_ns, 2'000'000'000);
}

}  // namespace
}  // namespace odoless
