// SocketCAN on a real kernel's vcan0; skipped where there is none.
#include "drivers/io/socket_can.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <net/if.h>

#include <array>
#include <cstdlib>
#include <vector>

#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr std::array<CanFilter, 1> kAll{{{.id = 0, .mask = 0}}};

CanFrame frame(std::uint32_t id, std::uint8_t first = 0) {
  CanFrame made;
  made.id = id;
  made.size_bytes = 8;
  made.data[0] = first;
  return made;
}

class SocketCan : public ::testing::Test {
 protected:
  void SetUp() override {
    if (::if_nametoindex("vcan0") == 0) {
      GTEST_SKIP() << "no interface vcan0: this kernel has no CAN, or nobody has made it (ip link add vcan0 type vcan)";
    }
    ASSERT_EQ(std::system("ip link set vcan0 up"), 0);
  }

  static FileDescriptor open(std::span<const CanFilter> filters) {
    Result<FileDescriptor> opened = open_can("vcan0", filters);
    EXPECT_TRUE(opened.ok()) << describe(opened.error());
    return opened.ok() ? opened.take() : FileDescriptor();
  }

  /// All frames that wait.
  static std::vector<CanReceived> drain(const FileDescriptor& socket) {
    std::vector<CanReceived> frames;
    CanReceived received;
    while (read_can(socket.get(), monotonic_ns(), received) == Errc::kOk) {
      frames.push_back(received);
    }
    return frames;
  }
};

TEST_F(SocketCan, CarriesFramesStampsThemAndEchoesOwnOnes) {
  const FileDescriptor one = open(kAll);
  const FileDescriptor other = open(kAll);
  const std::int64_t before_ns = monotonic_ns();
  ASSERT_EQ(write_can(one.get(), frame(0x123, 7)), Errc::kOk);
  ASSERT_EQ(write_can(one.get(), frame(0x12345678 | CanFrame::kExtendedFlag, 8)), Errc::kOk);
  for (const FileDescriptor* const socket : {&one, &other}) {
    const std::vector<CanReceived> heard = drain(*socket);
    ASSERT_EQ(heard.size(), 2U);
    EXPECT_EQ(heard[0].frame, frame(0x123, 7));
    EXPECT_EQ(heard[1].frame.id, 0x12345678 | CanFrame::kExtendedFlag);
    EXPECT_GE(heard[0].stamp_ns, before_ns - 2'000'000);
    EXPECT_LE(heard[0].stamp_ns, monotonic_ns());
  }
  CanReceived received;
  EXPECT_EQ(read_can(one.get(), monotonic_ns(), received), Errc::kNotYet);
}

TEST_F(SocketCan, HearsWhatItsFiltersLetThroughAndAllErrors) {
  constexpr std::array<CanFilter, 2> kTwo{{{.id = 0x181}, {.id = 0x701}}};
  const FileDescriptor filtered = open(kTwo);
  const FileDescriptor other = open(kAll);
  for (const std::uint32_t id : {0x000U, 0x080U, 0x181U, 0x182U, 0x701U, 0x181U | CanFrame::kExtendedFlag,
                                 CanFrame::kErrorFlag | CanFrame::kErrorBusOff}) {
    ASSERT_EQ(write_can(other.get(), frame(id)), Errc::kOk);
  }
  std::vector<std::uint32_t> ids;
  for (const CanReceived& received : drain(filtered)) {
    ids.push_back(received.frame.id);
  }
  EXPECT_THAT(ids, ::testing::ElementsAre(0x181U, 0x701U, CanFrame::kErrorFlag | CanFrame::kErrorBusOff));
}

TEST_F(SocketCan, AFloodOfOthersCostsNothing) {
  constexpr std::array<CanFilter, 1> kOne{{{.id = 0x181}}};
  const FileDescriptor filtered = open(kOne);
  const FileDescriptor other = open(kAll);
  for (int i = 0; i < 20'000; ++i) {
    const Errc error = write_can(other.get(), frame(0));
    ASSERT_TRUE(error == Errc::kOk || error == Errc::kCapacity) << describe(error);
    static_cast<void>(drain(other));
  }
  ASSERT_EQ(write_can(other.get(), frame(0x181, 9)), Errc::kOk);
  const std::vector<CanReceived> heard = drain(filtered);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].frame, frame(0x181, 9));
}

TEST_F(SocketCan, OutlivesALinkThatGoesDownAndUp) {
  const FileDescriptor one = open(kAll);
  const FileDescriptor other = open(kAll);
  ASSERT_EQ(std::system("ip link set vcan0 down"), 0);
  CanReceived received;
  EXPECT_EQ(write_can(one.get(), frame(1)), Errc::kLinkDown);
  EXPECT_EQ(read_can(other.get(), monotonic_ns(), received), Errc::kLinkDown);
  ASSERT_EQ(std::system("ip link set vcan0 up"), 0);
  static_cast<void>(drain(one));
  static_cast<void>(drain(other));
  EXPECT_EQ(write_can(one.get(), frame(2)), Errc::kOk);
  ASSERT_EQ(read_can(other.get(), monotonic_ns(), received), Errc::kOk);
  EXPECT_EQ(received.frame, frame(2));
}

TEST_F(SocketCan, SaysWhatCannotBeOpened) {
  EXPECT_EQ(open_can("nocan9", kAll).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_can("", kAll).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_can("a_name_that_is_far_too_long", kAll).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_can("lo", kAll).error(), Errc::kNotCan);
}

TEST_F(SocketCan, TellsThatTheInterfaceIsGone) {
  ASSERT_EQ(std::system("ip link add dev vcan9 type vcan && ip link set vcan9 up"), 0);
  Result<FileDescriptor> opened = open_can("vcan9", kAll);
  ASSERT_TRUE(opened.ok());
  const FileDescriptor socket = opened.take();
  ASSERT_EQ(std::system("ip link del vcan9"), 0);
  CanReceived received;
  Errc error = read_can(socket.get(), monotonic_ns(), received);
  if (error == Errc::kLinkDown) {  // told first, then the rest
    error = write_can(socket.get(), frame(1));
  }
  EXPECT_EQ(error, Errc::kDeviceMissing) << describe(error);
}

}  // namespace
}  // namespace odoless
