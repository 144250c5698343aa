#include "drivers/io/udp_listener.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

#include "drivers/io/device_line.hpp"

namespace odoless {
namespace {

constexpr std::uint16_t kPort = 45017;

void send_datagram(const std::string& bytes) {
  const FileDescriptor sender(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kPort);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(
      ::sendto(sender.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&address), sizeof(address)),
      static_cast<ssize_t>(bytes.size()));
}

ssize_t read_some(int descriptor) {
  std::array<char, 64> bytes{};
  return ::read(descriptor, bytes.data(), bytes.size());
}

TEST(UdpListener, HearsDatagramsAndTakesNoEmptyOneForAnEnd) {
  DeviceLine line("udp://127.0.0.1:" + std::to_string(kPort), 0);
  Result<FileDescriptor> opened = line.open();
  ASSERT_TRUE(opened.ok());
  const FileDescriptor listener = opened.take();
  EXPECT_EQ(read_some(listener.get()), -1) << "it does not wait";
  send_datagram("");
  EXPECT_EQ(read_some(listener.get()), -1);
  send_datagram("abc");
  EXPECT_EQ(read_some(listener.get()), 3);
  EXPECT_EQ(open_udp({"127.0.0.1", kPort}).error(), Errc::kDeviceBusy);
}

TEST(UdpListener, SaysWhatIsNoAddressOfThisMachine) {
  EXPECT_EQ(open_udp({"192.0.2.1", kPort}).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_udp({"localhost", kPort}).error(), Errc::kBadAddress) << "a name may take as long as its server likes";
  EXPECT_EQ(DeviceLine("udp://somewhere.local:5005", 0).open().error(), Errc::kBadAddress);
  EXPECT_EQ(DeviceLine("udp://127.0.0.1", 0).open().error(), Errc::kBadAddress);
}

}  // namespace
}  // namespace odoless
