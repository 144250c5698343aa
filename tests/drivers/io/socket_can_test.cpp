// Frames into a socket and out of it, where no CAN is: a pair of sockets that carry datagrams, as a bus does. What the
// kernel's CAN does besides is tested in the virtual machine (tests/hil/socket_can_test.cpp).
#include "drivers/io/socket_can.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

class CanOfASocket : public ::testing::Test {
 protected:
  void SetUp() override {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    near_ = FileDescriptor(ends[0]);
    far_ = FileDescriptor(ends[1]);
  }

  FileDescriptor near_;
  FileDescriptor far_;
  MonotonicClock clock_;
  CanReceived received_;
};

TEST_F(CanOfASocket, AFrameComesOutAsItWentIn) {
  const CanFrame frame{.id = 0x201 | CanFrame::kExtendedFlag, .size_bytes = 6, .data = {1, 2, 3, 4, 5, 6}};
  ASSERT_EQ(write_can(near_.get(), frame), Errc::kOk);
  ASSERT_EQ(read_can(far_.get(), clock_, received_), Errc::kOk);
  EXPECT_EQ(received_.frame, frame);
  EXPECT_EQ(read_can(far_.get(), clock_, received_), Errc::kNotYet);
}

TEST_F(CanOfASocket, AStampIsWhenTheFrameCame) {
  const int on = 1;
  ASSERT_EQ(::setsockopt(far_.get(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)), 0);
  const std::int64_t before_ns = clock_.now_ns();
  ASSERT_EQ(write_can(near_.get(), {.id = 0x181}), Errc::kOk);
  const std::int64_t after_ns = clock_.now_ns();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_EQ(read_can(far_.get(), clock_, received_), Errc::kOk);
  EXPECT_GE(received_.stamp_ns, before_ns - kMs);
  EXPECT_LE(received_.stamp_ns, after_ns + kMs);
}

TEST_F(CanOfASocket, WithoutAStampItCameWhenItWasRead) {
  ASSERT_EQ(write_can(near_.get(), {.id = 0x181}), Errc::kOk);
  const std::int64_t before_ns = clock_.now_ns();
  ASSERT_EQ(read_can(far_.get(), clock_, received_), Errc::kOk);
  EXPECT_GE(received_.stamp_ns, before_ns);
  EXPECT_LE(received_.stamp_ns, clock_.now_ns());
}

TEST_F(CanOfASocket, HalfAFrameIsNone) {
  const std::array<char, sizeof(CanFrame) / 2> half{};
  ASSERT_EQ(::write(near_.get(), half.data(), half.size()), static_cast<ssize_t>(half.size()));
  EXPECT_EQ(read_can(far_.get(), clock_, received_), Errc::kDeviceFailed);
}

TEST_F(CanOfASocket, AFrameThatFindsNoRoomIsDroppedAndTheNextMayPass) {
  Errc error = Errc::kOk;
  for (int i = 0; i < 100'000 && error == Errc::kOk; ++i) {
    error = write_can(near_.get(), {.id = 0x181});
  }
  EXPECT_EQ(error, Errc::kCapacity);
  while (read_can(far_.get(), clock_, received_) == Errc::kOk) {
  }
  EXPECT_EQ(write_can(near_.get(), {.id = 0x181}), Errc::kOk);
}

TEST_F(CanOfASocket, ASocketThatIsNoneIsToBeOpenedAnew) {
  EXPECT_EQ(write_can(-1, {.id = 0x181}), Errc::kDeviceFailed);
  EXPECT_EQ(read_can(-1, clock_, received_), Errc::kDeviceFailed);
}

}  // namespace
}  // namespace odoless
