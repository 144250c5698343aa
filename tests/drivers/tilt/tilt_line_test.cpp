// The line of a servo, bytes or frames by its driver, over a pair of sockets.
#include "drivers/tilt/tilt_line.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace odoless {
namespace {

class TiltLine : public ::testing::TestWithParam<TiltDriver> {
 protected:
  void SetUp() override {
    std::array<int, 2> ends{};
    const int kind = is_can() ? SOCK_SEQPACKET : SOCK_STREAM;
    ASSERT_EQ(::socketpair(AF_UNIX, kind | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    near_ = FileDescriptor(ends[0]);
    far_ = FileDescriptor(ends[1]);
  }
  [[nodiscard]] static bool is_can() { return GetParam() == TiltDriver::kCia402; }
  [[nodiscard]] Result<TiltRead> read() { return read_tilt_line(GetParam(), far_.get(), buffer_, clock_); }
  [[nodiscard]] Errc write(std::span<const std::byte> bytes) const {
    return write_tilt_line(GetParam(), near_.get(), bytes);
  }

  FileDescriptor near_;
  FileDescriptor far_;
  MonotonicClock clock_;
  std::array<std::byte, 64> buffer_{};
  std::vector<std::byte> sent_{sizeof(CanFrame), std::byte{5}};  // five bytes of data, of some id
};

TEST_P(TiltLine, WhatIsSentArrivesWithItsTime) {
  const std::int64_t before_ns = clock_.now_ns();
  ASSERT_EQ(write(sent_), Errc::kOk);
  const Result<TiltRead> got = read();
  ASSERT_TRUE(got.ok());
  EXPECT_TRUE(std::equal(got.value().bytes.begin(), got.value().bytes.end(), sent_.begin(), sent_.end()));
  EXPECT_GE(got.value().arrival_ns, before_ns);
  EXPECT_LE(got.value().arrival_ns, clock_.now_ns());
  EXPECT_EQ(read().error(), Errc::kNotYet);
}

TEST_P(TiltLine, AFullLineTakesNothingAndIsGood) {
  Errc error = Errc::kOk;
  for (int i = 0; i < 1'000'000 && error == Errc::kOk; ++i) {
    error = write(sent_);
  }
  EXPECT_EQ(error, Errc::kCapacity);
  EXPECT_TRUE(read().ok());
}

TEST_P(TiltLine, AFarEndThatIsGoneIsTold) {
  near_ = FileDescriptor();
  EXPECT_EQ(read().error(), is_can() ? Errc::kDeviceFailed : Errc::kDeviceMissing);
}

TEST(TiltLineOfCan, TakesWholeFramesOnly) {
  const std::array<std::byte, 3> part{};
  EXPECT_EQ(write_tilt_line(TiltDriver::kCia402, -1, part), Errc::kFrameMalformed);
}

INSTANTIATE_TEST_SUITE_P(Drivers, TiltLine,
                         ::testing::Values(TiltDriver::kCia402, TiltDriver::kDynamixel, TiltDriver::kMaestro));

}  // namespace
}  // namespace odoless
