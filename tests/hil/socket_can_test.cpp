// SocketCAN on a real kernel's vcan0; skipped where there is none.
#include "drivers/io/socket_can.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <net/if.h>
#include <poll.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <utility>
#include <vector>

#include "rt/clock.hpp"

namespace odoless {
namespace {

constexpr int kWaitMs = 5000;
constexpr auto kHeldUp = std::chrono::milliseconds(20);
constexpr std::array<CanFilter, 1> kAll{{{.id = 0, .mask = 0}}};

CanFrame frame(std::uint32_t id, std::uint8_t first = 0) {
  CanFrame made;
  made.id = id;
  made.size_bytes = 8;
  made.data[0] = first;
  return made;
}

/// Its reader is held up for a while after it was read for the first time.
class HeldUpClock final : public Clock {
 public:
  explicit HeldUpClock(const Clock& clock) : clock_(clock) {}
  [[nodiscard]] std::int64_t now_ns() const override {
    const std::int64_t now_ns = clock_.now_ns();
    if (!std::exchange(was_held_up_, true)) {
      std::this_thread::sleep_for(kHeldUp);
    }
    return now_ns;
  }
  void sleep_until(std::int64_t /*stamp_ns*/) override {}

 private:
  const Clock& clock_;
  mutable bool was_held_up_ = false;
};

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

  /// All frames up to `last`, which is waited for: a busy kernel brings frames after the call that has sent them, but
  /// in their order.
  [[nodiscard]] std::vector<CanReceived> hear_until(const FileDescriptor& socket, const CanFrame& last) const {
    std::vector<CanReceived> frames;
    pollfd ready{.fd = socket.get(), .events = POLLIN, .revents = 0};
    while (frames.empty() || frames.back().frame != last) {
      CanReceived received;
      const bool is_ready = ::poll(&ready, 1, kWaitMs) == 1;
      if (const Errc error = is_ready ? read_can(socket.get(), clock_, received) : Errc::kNotYet; error != Errc::kOk) {
        ADD_FAILURE() << "instead of the last frame: " << describe(error);
        break;
      }
      frames.push_back(received);
    }
    return frames;
  }

  MonotonicClock clock_;
};

TEST_F(SocketCan, CarriesFramesStampsThemAndEchoesOwnOnes) {
  const FileDescriptor one = open(kAll);
  const FileDescriptor other = open(kAll);
  const std::int64_t before_ns = clock_.now_ns();
  ASSERT_EQ(write_can(one.get(), frame(0x123, 7)), Errc::kOk);
  const CanFrame extended = frame(0x12345678 | CanFrame::kExtendedFlag, 8);
  ASSERT_EQ(write_can(one.get(), extended), Errc::kOk);
  for (const FileDescriptor* const socket : {&one, &other}) {
    const std::vector<CanReceived> heard = hear_until(*socket, extended);
    ASSERT_EQ(heard.size(), 2U);
    EXPECT_EQ(heard[0].frame, frame(0x123, 7));
    EXPECT_GE(heard[0].stamp_ns, before_ns - 2'000'000);
    EXPECT_LE(heard[0].stamp_ns, clock_.now_ns());
  }
  CanReceived received;
  EXPECT_EQ(read_can(one.get(), clock_, received), Errc::kNotYet);
}

TEST_F(SocketCan, StampsAFrameByWhenItCameHoweverLateItIsRead) {
  constexpr int kRounds = 50;
  const FileDescriptor one = open(kAll);
  std::int64_t too_late_ns = 1;
  for (int i = 0; i < kRounds && too_late_ns > 0; ++i) {  // the kernel begins to stamp a while after it was asked to
    const std::int64_t before_ns = clock_.now_ns();
    ASSERT_EQ(write_can(one.get(), frame(1)), Errc::kOk);
    const std::int64_t after_ns = clock_.now_ns();
    pollfd ready{.fd = one.get(), .events = POLLIN, .revents = 0};
    ASSERT_EQ(::poll(&ready, 1, kWaitMs), 1);
    std::this_thread::sleep_for(kHeldUp);
    CanReceived received;
    ASSERT_EQ(read_can(one.get(), HeldUpClock(clock_), received), Errc::kOk);
    ASSERT_GE(received.stamp_ns, before_ns - 2'000'000);
    too_late_ns = received.stamp_ns - (after_ns + 2'000'000);
  }
  EXPECT_LE(too_late_ns, 0);
}

TEST_F(SocketCan, HearsWhatItsFiltersLetThroughAndAllErrors) {
  constexpr std::array<CanFilter, 2> kTwo{{{.id = 0x181}, {.id = 0x701}}};
  const FileDescriptor filtered = open(kTwo);
  const FileDescriptor other = open(kAll);
  constexpr std::uint32_t kBusOff = CanFrame::kErrorFlag | CanFrame::kErrorBusOff;
  for (const std::uint32_t id : {0x000U, 0x080U, 0x181U, 0x182U, 0x701U, 0x181U | CanFrame::kExtendedFlag, kBusOff}) {
    ASSERT_EQ(write_can(other.get(), frame(id)), Errc::kOk);
  }
  std::vector<std::uint32_t> ids;
  for (const CanReceived& received : hear_until(filtered, frame(kBusOff))) {
    ids.push_back(received.frame.id);
  }
  EXPECT_THAT(ids, ::testing::ElementsAre(0x181U, 0x701U, kBusOff));
}

TEST_F(SocketCan, AFloodOfOthersCostsNothing) {
  constexpr std::array<CanFilter, 1> kOne{{{.id = 0x181}}};
  const FileDescriptor filtered = open(kOne);
  const FileDescriptor other = open(kAll);
  for (int i = 0; i < 20'000; ++i) {
    ASSERT_EQ(write_can(other.get(), frame(0)), Errc::kOk);
    ASSERT_EQ(hear_until(other, frame(0)).size(), 1U) << "a bus carries a frame before the next";
  }
  ASSERT_EQ(write_can(other.get(), frame(0x181, 9)), Errc::kOk);
  EXPECT_EQ(hear_until(filtered, frame(0x181, 9)).size(), 1U);
}

TEST_F(SocketCan, OutlivesALinkThatGoesDownAndUp) {
  const FileDescriptor one = open(kAll);
  const FileDescriptor other = open(kAll);
  ASSERT_EQ(std::system("ip link set vcan0 down"), 0);
  CanReceived received;
  EXPECT_EQ(write_can(one.get(), frame(1)), Errc::kLinkDown);
  EXPECT_EQ(read_can(other.get(), clock_, received), Errc::kLinkDown);
  ASSERT_EQ(std::system("ip link set vcan0 up"), 0);
  EXPECT_EQ(write_can(one.get(), frame(2)), Errc::kOk);
  EXPECT_EQ(hear_until(other, frame(2)).size(), 1U);
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
  Errc error = read_can(socket.get(), clock_, received);
  if (error == Errc::kLinkDown) {  // told first, then the rest
    error = write_can(socket.get(), frame(1));
  }
  EXPECT_EQ(error, Errc::kDeviceMissing) << describe(error);
}

}  // namespace
}  // namespace odoless
