#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "tools/emulate/usb_cdc_device.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

std::string number(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes += static_cast<char>(value >> shift & 0xff);
  }
  return bytes;
}

const std::string kNoSetup(8, '\0');

/// USBIP_CMD_SUBMIT, as Documentation/usb/usbip_protocol.rst of Linux has it. @param rest  Set-up and data.
std::string submit(std::uint32_t sequence, bool in, std::uint32_t endpoint, std::uint32_t size_bytes,
                   const std::string& rest = kNoSetup) {
  return number(1) + number(sequence) + number(0x10002) + number(in ? 1 : 0) + number(endpoint) + number(0) +
         number(size_bytes) + number(0) + number(0) + number(0) + rest;
}

std::string unlink(std::uint32_t sequence, std::uint32_t victim) {
  return number(2) + number(sequence) + number(0x10002) + number(0) + number(0) + number(victim) +
         std::string(24, '\0');
}

std::string reply(std::uint32_t sequence, std::uint32_t status, std::uint32_t size_bytes, const std::string& data) {
  return number(3) + number(sequence) + std::string(12, '\0') + number(status) + number(size_bytes) +
         std::string(20, '\0') + data;
}

const std::string kGetDevice("\x80\x06\x00\x01\x00\x00\x12\x00", 8);
const std::string kGetSerial("\x80\x06\x03\x03\x09\x04\xff\x00", 8);
const std::string kGetQualifier("\x80\x06\x00\x06\x00\x00\x0a\x00", 8);
const std::string kOpen("\x21\x22\x03\x00\x00\x00\x00\x00", 8);

TEST(UsbCdcDevice, SaysWhatItIs) {
  UsbCdcDevice device({.serial = "AB"});
  device.receive(submit(1, true, 0, 18, kGetDevice));
  const std::string answer = device.take_output();
  ASSERT_EQ(answer.size(), 48U + 18U);
  EXPECT_EQ(answer.substr(48 + 8, 4), std::string("\xd1\x15\x00\x00", 4)) << "vendor and product";
  device.receive(submit(2, true, 0, 255, kGetSerial));
  EXPECT_EQ(device.take_output(), reply(2, 0, 6,
                                        std::string("\x06\x03"
                                                    "A\0B\0",
                                                    6)));
  device.receive(submit(3, true, 0, 10, kGetQualifier));
  EXPECT_EQ(device.take_output(), reply(3, static_cast<std::uint32_t>(-32), 0, "")) << "a stall: it has none";
}

TEST(UsbCdcDevice, CarriesBytesBothWaysOnceItIsOpen) {
  UsbCdcDevice device({});
  EXPECT_FALSE(device.is_open());
  device.receive(submit(1, false, 0, 0, kOpen));
  EXPECT_TRUE(device.is_open());
  static_cast<void>(device.take_output());
  device.receive(submit(2, true, 2, 4) + submit(3, false, 2, 3, kNoSetup + "QT\n"));
  EXPECT_EQ(device.take_received(), "QT\n");
  EXPECT_EQ(device.take_output(), reply(3, 0, 3, ""));
  EXPECT_EQ(device.send("00P\n\n"), 5U);
  EXPECT_EQ(device.take_output(), reply(2, 0, 4, "00P\n")) << "what fits into the request that waited";
  device.receive(submit(4, true, 2, 64));
  EXPECT_EQ(device.take_output(), reply(4, 0, 1, "\n"));
}

TEST(UsbCdcDevice, ForgetsARequestThatIsTakenBack) {
  UsbCdcDevice device({});
  device.receive(submit(1, true, 2, 64) + unlink(2, 1));
  EXPECT_EQ(device.take_output(), number(4) + number(2) + std::string(12, '\0') +
                                      number(static_cast<std::uint32_t>(-104)) + std::string(24, '\0'));
  static_cast<void>(device.send("x"));
  EXPECT_EQ(device.take_output(), "");
}

TEST(UsbCdcDevice, HasNoEndlessMemoryForAHostThatDoesNotRead) {
  UsbCdcDevice device({});
  const std::string much(1000, 'x');
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) {
    taken += device.send(much);
  }
  EXPECT_LT(taken, 100'000U);
}

RC_GTEST_PROP(UsbCdcDevice, AnySplitGivesTheSame, ()) {
  const std::string all = submit(1, true, 0, 18, kGetDevice) + submit(2, false, 0, 0, kOpen) + submit(3, true, 2, 64) +
                          submit(4, false, 2, 3, kNoSetup + "VV\n") + unlink(5, 3);
  UsbCdcDevice whole({});
  whole.receive(all);
  UsbCdcDevice split({});
  const auto at = *rc::gen::inRange<std::size_t>(0, all.size());
  split.receive(std::string_view(all).substr(0, at));
  split.receive(std::string_view(all).substr(at));
  RC_ASSERT(split.take_output() == whole.take_output());
  RC_ASSERT(split.take_received() == whole.take_received());
}

RC_GTEST_PROP(UsbCdcDevice, TakesAnyBytes, ()) {
  UsbCdcDevice device({});
  const auto header = *rc::gen::element<std::string>("", number(1), number(2), number(1) + number(7) + number(0));
  device.receive(header + *rc::gen::string<std::string>() + std::string(*rc::gen::inRange<std::size_t>(0, 100), '\0'));
  RC_ASSERT(device.take_output().size() < 100'000U);
}

}  // namespace
}  // namespace odoless
