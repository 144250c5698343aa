#include "firmware/sources/line_end.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "drivers/io/file_descriptor.hpp"
#include "drivers/io/tcp_client.hpp"
#include "firmware/sources/lrf_source.hpp"

namespace odoless {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class LogSink final : public ScanSink {
 public:
  void on_scan(const RawScan& /*scan*/) override {}
  void on_motion(const Motion& /*motion*/) override {}
  void on_raw(RawLine /*line*/, std::span<const std::byte> /*bytes*/, bool /*to_device*/) override {}
  void on_tilt(const TiltRecord& /*tilt*/) override {}
  void on_event(EventPriority /*priority*/, EventText text, std::int64_t number) override {
    log.push_back(fmt::format(fmt::runtime(fmt::string_view(text)), number));
  }

  std::vector<std::string> log;
};

/// A device on a real TCP port, connected to.
class TcpDevice {
 public:
  TcpDevice() {
    const FileDescriptor listener(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener.get(), any, size), 0);
    EXPECT_EQ(::listen(listener.get(), 1), 0);
    EXPECT_EQ(::getsockname(listener.get(), any, &size), 0);
    Result<FileDescriptor> opened = open_tcp({.host = "127.0.0.1", .port = ntohs(address.sin_port)});
    EXPECT_TRUE(opened.ok());
    near_ = opened.take();
    far_ = FileDescriptor(::accept(listener.get(), nullptr, nullptr));
  }

  [[nodiscard]] int near() const { return near_.get(); }
  void close() { far_.reset(); }
  /// As a device does that has lost its power and hears of a connection that it doesn't know.
  void reset() {
    const linger at_once{.l_onoff = 1, .l_linger = 0};
    EXPECT_EQ(::setsockopt(far_.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once)), 0);
    far_.reset();
  }

 private:
  FileDescriptor near_;
  FileDescriptor far_;
};

/// What a laser's source says until it gives its line back.
std::vector<std::string> said_of(int descriptor, const std::string& address) {
  LrfParams params;
  params.device = address;
  LineHandover line;
  line.offer(descriptor);
  LrfSource source(params, 2048, line);
  LogSink sink;
  pollfd ready{.fd = descriptor, .events = POLLIN, .revents = 0};
  EXPECT_EQ(::poll(&ready, 1, 2000), 1);
  source.work(ManualClock(1'000'000'000), sink);
  EXPECT_EQ(line.take_back(), descriptor);
  return sink.log;
}

TEST(LineEnd, ALaserThatClosesItsConnectionIsSaidToHaveClosedIt) {
  TcpDevice device;
  device.close();
  EXPECT_THAT(said_of(device.near(), "tcp://127.0.0.1:10940"),
              ::testing::ElementsAre(StartsWith("laser: the device closed the connection; ")));
}

TEST(LineEnd, ALaserThatBreaksItsConnectionOffIsSaidToHaveDoneSo) {
  TcpDevice device;
  device.reset();
  EXPECT_THAT(said_of(device.near(), "tcp://127.0.0.1:10940"),
              ::testing::ElementsAre(HasSubstr("the device broke the connection off")));
}

TEST(LineEnd, ASerialLineThatEndsIsSaidToBeUnplugged) {
  int ends[2]{-1, -1};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
  const FileDescriptor near(ends[0]);
  ::close(ends[1]);
  EXPECT_THAT(said_of(near.get(), "/dev/ttyACM0"), ::testing::ElementsAre(HasSubstr("unplugged or closed")));
}

TEST(LineEnd, EachHasItsOwnWordsAndOnlyAnUnknownOneANumber) {
  const auto line = [](int error_number) {
    return fmt::format(fmt::runtime(fmt::string_view(laser_line_text(line_end_of(true, error_number)))), error_number);
  };
  EXPECT_THAT(line(ETIMEDOUT), HasSubstr("timed out"));
  EXPECT_THAT(line(EHOSTUNREACH), HasSubstr("cannot be reached"));
  EXPECT_THAT(line(EIO), HasSubstr("unplugged"));
  EXPECT_THAT(line(ENOMEM), HasSubstr("errno 12"));
  EXPECT_THAT((std::vector{line(0), line(ECONNRESET), line(ETIMEDOUT), line(ENETDOWN), line(EIO)}),
              Each(Not(HasSubstr("errno"))));
}

}  // namespace
}  // namespace odoless
