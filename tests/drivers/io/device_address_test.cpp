#include "drivers/io/device_address.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace odoless {
namespace {

TEST(DeviceAddress, IsAPathWithoutAScheme) {
  EXPECT_EQ(std::get<SerialAddress>(parse_device_address("/dev/ttyACM0").value()).path, "/dev/ttyACM0");
}

TEST(DeviceAddress, TcpHasAHostAndAPort) {
  EXPECT_EQ(std::get<TcpAddress>(parse_device_address("tcp://192.168.0.10:10940").value()),
            (TcpAddress{.host = "192.168.0.10", .port = 10940}));
  EXPECT_EQ(std::get<TcpAddress>(parse_device_address("tcp://[fe80::1]:1").value()),
            (TcpAddress{.host = "fe80::1", .port = 1}));
}

TEST(DeviceAddress, TcpMayHaveAName) {
  for (const char* const host : {"localhost", "laser", "laser-2.robot.local", "3com.example", "a1.b2c"}) {
    EXPECT_EQ(std::get<TcpAddress>(parse_device_address(std::string("tcp://") + host + ":7").value()),
              (TcpAddress{.host = host, .port = 7}));
  }
  for (const char* const wrong : {"tcp://-a:1", "tcp://a..b:1", "tcp://.a:1", "tcp://a_b:1", "tcp://a b:1",
                                  "tcp://a/b:1", "tcp://1.2.3.400:1", "tcp://[laser:1", "tcp://:1"}) {
    EXPECT_EQ(parse_device_address(wrong).error(), Errc::kBadAddress) << wrong;
  }
  EXPECT_FALSE(parse_device_address("tcp://" + std::string(254, 'a') + ":1").ok());
}

TEST(DeviceAddress, UsbHasHexadecimalNumbersAndPerhapsASerialNumber) {
  EXPECT_EQ(std::get<UsbAddress>(parse_device_address("usb://15d1:0000").value()),
            (UsbAddress{.vendor = 0x15d1, .product = 0, .serial = ""}));
  EXPECT_EQ(std::get<UsbAddress>(parse_device_address("usb://0403:6001/A/7").value()),
            (UsbAddress{.vendor = 0x0403, .product = 0x6001, .serial = "A/7"}));
}

TEST(DeviceAddress, UdpIsANumberOfThisMachine) {
  EXPECT_EQ(std::get<UdpAddress>(parse_device_address("udp://0.0.0.0:5005").value()),
            (UdpAddress{.host = "0.0.0.0", .port = 5005}));
}

TEST(DeviceAddress, OnlyASerialLineHasARateOfOurs) {
  EXPECT_TRUE(is_serial("/dev/ttyS0"));
  EXPECT_FALSE(is_serial("tcp://192.168.0.10:4001"));
  EXPECT_FALSE(is_serial("usb://0403:6001"));
  EXPECT_FALSE(is_serial("tcp://laser"));
}

TEST(DeviceAddress, RefusesWhatIsNeither) {
  for (const char* const wrong :
       {"", "tcp://", "tcp://laser", "tcp://1.2.3.4", "tcp://1.2.3.4:0", "tcp://1.2.3.4:65536", "tcp://1.2.3.4:-1",
        "tcp://1.2.3:80", "usb://", "usb://15d1", "usb://15d1:", "usb://15d1:10000", "usb://15d1:0000/", "usb://x:y",
        "usb://+1:0", "udp://1.2.3.4", "udp://laser:5", "http://x"}) {
    EXPECT_EQ(parse_device_address(wrong).error(), Errc::kBadAddress) << wrong;
  }
}

RC_GTEST_PROP(DeviceAddress, TakesOrRefusesAnyText, ()) {
  const auto text = *rc::gen::string<std::string>();
  const auto scheme = *rc::gen::element<std::string>("", "tcp://", "usb://", "usb://1:", "tcp://[");
  const auto address = parse_device_address(scheme + text);
  RC_ASSERT(address.ok() || address.error() == Errc::kBadAddress);
}

}  // namespace
}  // namespace odoless
