#include "drivers/io/name_lookup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <set>
#include <string>
#include <vector>

#include "drivers/io/device_line.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kLong_ns = 5'000'000'000;

TEST(NameLookup, ANumberIsItsOwnAddress) {
  NameLookup lookup;
  EXPECT_THAT(lookup.find("192.168.0.10").value(), ::testing::ElementsAre("192.168.0.10"));
  EXPECT_THAT(lookup.find("fe80::1").value(), ::testing::ElementsAre("fe80::1"));
}

TEST(NameLookup, KnowsThisHost) {
  NameLookup lookup;
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(lookup.find("localhost", kLong_ns).value(), ::testing::Contains(::testing::AnyOf("127.0.0.1", "::1")));
  }
}

// Each is tried, and waited for where nothing answers.
TEST(NameLookup, GivesEachAddressOnce) {
  NameLookup lookup;
  const std::vector<std::string> addresses = lookup.find("localhost", kLong_ns).value();
  EXPECT_EQ(std::set<std::string>(addresses.begin(), addresses.end()).size(), addresses.size());
}

TEST(NameLookup, ANameThatNobodyKnowsIsMissingAndHoldsNobodyUp) {
  NameLookup lookup;  // .invalid is nobody's (RFC 2606); where no name server answers, the search goes on
  for (int i = 0; i < 3; ++i) {
    const std::int64_t begin_ns = monotonic_ns();
    EXPECT_EQ(lookup.find("laser.invalid", 50'000'000).error(), Errc::kDeviceMissing);
    EXPECT_LT(monotonic_ns() - begin_ns, kLong_ns);
  }
}

TEST(NameLookup, OneThatIsLeftUnderWayHarmsNothing) {
  for (int i = 0; i < 20; ++i) {
    NameLookup lookup;
    static_cast<void>(lookup.find("laser.invalid", 0).ok());
  }
}

TEST(DeviceLine, FindsADeviceByItsNameAtWhicheverAddressItListens) {
  const FileDescriptor device(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;  // and not at ::1, which a name server may give first
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size_bytes = sizeof(address);
  ASSERT_EQ(::bind(device.get(), reinterpret_cast<sockaddr*>(&address), size_bytes), 0);
  ASSERT_EQ(::listen(device.get(), 4), 0);
  ASSERT_EQ(::getsockname(device.get(), reinterpret_cast<sockaddr*>(&address), &size_bytes), 0);
  DeviceLine line("tcp://localhost:" + std::to_string(ntohs(address.sin_port)), 0);
  Errc error = Errc::kDeviceMissing;
  for (int i = 0; i < 20 && error == Errc::kDeviceMissing; ++i) {  // a busy machine's lookup takes its time
    error = line.open().error();
  }
  EXPECT_EQ(error, Errc::kOk) << describe(error);
  EXPECT_EQ(DeviceLine("tcp://laser.invalid:7", 0).open().error(), Errc::kDeviceMissing);
}

}  // namespace
}  // namespace odoless
