#include "drivers/io/usb_serial.hpp"

#include <gtest/gtest.h>

#include "drivers/io/device_line.hpp"

// What a device says and does is tested in the virtual machine (tests/hil), which has one.
namespace odoless {
namespace {

TEST(UsbSerial, SaysThatADeviceIsNotThere) {
  const auto opened = UsbSerial::open({.vendor = 0xffff, .product = 0xfffe, .serial = ""}, 0);
  // Where there is no USB at all, libusb cannot start.
  EXPECT_TRUE(opened.error() == Errc::kDeviceMissing || opened.error() == Errc::kDeviceFailed);
}

TEST(DeviceLine, OpensByTheKindOfAddress) {
  EXPECT_EQ(DeviceLine("/nowhere/at/all", 0).open().error(), Errc::kDeviceMissing);
  EXPECT_EQ(DeviceLine("tcp://127.0.0.1:1", 0).open().error(), Errc::kDeviceMissing);
  EXPECT_EQ(DeviceLine("tcp://laser", 0).open().error(), Errc::kBadAddress);
  EXPECT_NE(DeviceLine("usb://ffff:fffe", 0).open().error(), Errc::kBadAddress);
}

}  // namespace
}  // namespace odoless
