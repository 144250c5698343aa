#include "drivers/lrf/device_clock.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/rng.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;
using test::kSecond;
constexpr std::int64_t kDelayNs = 19 * kMs;

/// A device whose true times are known, and whose bytes come late by chance.
struct Device {
  double drift_ppm = 0.0;
  double jitter_ms = 0.0;
  std::int64_t period_ns = 25 * kMs;
  double counter_start_ms = 123.4;
  std::int64_t origin_ns = 5000 * kSecond;
  Rng rng{7};

  [[nodiscard]] std::int64_t true_ns(int scan) const { return origin_ns + scan * period_ns; }
  [[nodiscard]] std::uint32_t counter_ms(int scan) const {
    const double ms = counter_start_ms + static_cast<double>(scan * period_ns) * 1e-6 * (1.0 + drift_ppm * 1e-6);
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(ms) & 0xFFFFFF);
  }
  [[nodiscard]] std::int64_t arrival_ns(int scan) {
    return true_ns(scan) + kDelayNs + std::llround(rng.uniform(0.0, jitter_ms) * 1e6);
  }
};

/// The largest error from `from_scan` on, in milliseconds; every stamp must be accepted and later than the one before.
double worst_ms(DeviceClock& clock, Device& device, int from_scan, int scans) {
  double worst = 0.0;
  std::int64_t last_ns = 0;
  for (int scan = 0; scan < scans; ++scan) {
    const Result<std::int64_t> stamp_ns = clock.host_ns(device.counter_ms(scan), device.arrival_ns(scan));
    EXPECT_TRUE(stamp_ns.ok()) << "scan " << scan;
    if (stamp_ns.ok()) {
      EXPECT_GT(stamp_ns.value(), last_ns);
      EXPECT_EQ(stamp_ns.value() % 1000, 0);
      last_ns = stamp_ns.value();
      const double error_ms = std::abs(static_cast<double>(last_ns - device.true_ns(scan))) * 1e-6;
      worst = scan >= from_scan ? std::max(worst, error_ms) : worst;
    }
  }
  return worst;
}

TEST(DeviceClock, IsExactWithoutDriftAndJitter) {
  DeviceClock clock;
  clock.start(25 * kMs, kDelayNs);
  Device device;
  EXPECT_LT(worst_ms(clock, device, 0, 4000), 0.1);
}

// The promise: within 1 ms after 10 s, for whatever chance makes of the jitter, forwards and backwards, through a wrap.
// (A drift so slow that the counter loses the same part of a millisecond for many seconds costs up to 1.3 ms.)
RC_GTEST_PROP(DeviceClock, IsWithinAMillisecondAfterTenSeconds, ()) {
  Device device;
  device.drift_ppm = *rc::gen::element(-1000.0, -300.0, 300.0, 1000.0);
  device.jitter_ms = 5.0;
  device.period_ns = *rc::gen::element<std::int64_t>(25 * kMs, 28 * kMs + kMs / 5);
  device.counter_start_ms = (1 << 24) - 12'000.0 + *rc::gen::inRange(0, 1000) * 1e-3;
  device.rng = Rng(*rc::gen::arbitrary<std::uint32_t>());
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  const double worst = worst_ms(clock, device, static_cast<int>(10 * kSecond / device.period_ns), 2000);
  RC_ASSERT(worst < 1.0);
  RC_ASSERT(clock.resets() == 0U);
}

TEST(DeviceClock, StampsAreNeverFarOffEvenAtFirst) {
  Device device{.drift_ppm = 1000.0, .jitter_ms = 5.0};
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  EXPECT_LT(worst_ms(clock, device, 0, 400), 5.5);
}

/// As a device that takes longer than is known to send what it has measured.
constexpr std::int64_t kLatencyNs = 8 * kMs;

double worst_of_late_bytes_ms(double drift_ppm, const std::optional<ClockReading>& reading) {
  Device device{.drift_ppm = drift_ppm, .jitter_ms = 3.0};
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs - kLatencyNs);
  if (reading) {
    clock.compare(*reading);
  }
  return worst_ms(clock, device, 400, 2000);
}

TEST(DeviceClock, AReadingTellsTheLatencyThatArrivalsCannot) {
  const Device device;
  const ClockReading reading{device.counter_ms(0) - 40, device.origin_ns - 40 * kMs};
  for (const double drift_ppm : {0.0, 100.0, -100.0}) {
    EXPECT_GT(worst_of_late_bytes_ms(drift_ppm, {}), 7.0);
    EXPECT_LT(worst_of_late_bytes_ms(drift_ppm, reading), 1.5);
  }
}

TEST(DeviceClock, AReadingOfAnotherClockTellsNothing) {
  const Device device;
  for (const std::int64_t wrong_by_ns : {-kSecond, kSecond}) {
    const ClockReading reading{device.counter_ms(0) - 40, device.origin_ns - 40 * kMs + wrong_by_ns};
    const double worst_error_ms = worst_of_late_bytes_ms(0.0, reading);
    EXPECT_GT(worst_error_ms, 7.0);
    EXPECT_LT(worst_error_ms, 9.5);
  }
}

TEST(DeviceClock, AResetCostsTwoScansAndMakesNoJump) {
  Device device{.jitter_ms = 2.0};
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  static_cast<void>(worst_ms(clock, device, 0, 500));
  int refused = 0;
  for (int scan = 500; scan < 900; ++scan) {
    const auto counter_ms = static_cast<std::uint32_t>((scan - 500) * 25);
    const Result<std::int64_t> stamp_ns = clock.host_ns(counter_ms, device.arrival_ns(scan));
    refused += stamp_ns.ok() ? 0 : 1;
    if (stamp_ns.ok()) {
      EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(scan)), 3 * kMs) << scan;
    }
  }
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(clock.resets(), 1U);
}

TEST(DeviceClock, AStreamThatStartsAnewWithAnotherCounterLosesNothing) {
  Device device;
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  static_cast<void>(worst_ms(clock, device, 0, 500));
  clock.start(device.period_ns, kDelayNs);
  const Result<std::int64_t> stamp_ns = clock.host_ns(7, device.arrival_ns(700));
  ASSERT_TRUE(stamp_ns.ok());
  EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(700)), kMs);
}

TEST(DeviceClock, AnotherDeviceWhoseCounterIsALittleAheadIsNotTakenForALateScan) {
  Device device;
  for (const std::uint32_t ahead_ms : {20U, 100U, 900U, 1900U}) {
    DeviceClock clock;
    clock.start(device.period_ns, kDelayNs);
    static_cast<void>(worst_ms(clock, device, 0, 100));
    clock.start(device.period_ns, kDelayNs);
    for (int scan = 180; scan < 200; ++scan) {  // 2 s later
      const std::uint32_t counter_ms = device.counter_ms(99) + ahead_ms + static_cast<std::uint32_t>(scan - 180) * 25;
      const Result<std::int64_t> stamp_ns = clock.host_ns(counter_ms, device.arrival_ns(scan));
      ASSERT_TRUE(stamp_ns.ok()) << ahead_ms;
      EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(scan)), kMs) << ahead_ms;
    }
  }
}

TEST(DeviceClock, ACounterThatWasSetBackForSecondsIsSeenAfterEightScans) {
  Device device{.jitter_ms = 3.0};
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  static_cast<void>(worst_ms(clock, device, 0, 400));
  for (int scan = 480; scan < 600; ++scan) {  // the device was away for 2 s, and its counter goes on where it was
    const Result<std::int64_t> stamp_ns = clock.host_ns(device.counter_ms(scan - 80), device.arrival_ns(scan));
    ASSERT_TRUE(stamp_ns.ok());
    if (scan >= 488) {
      EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(scan)), 4 * kMs) << scan;
    }
  }
  EXPECT_EQ(clock.resets(), 1U);
}

TEST(DeviceClock, AWrongStampIsRefusedAndTeachesNothing) {
  Device device{.jitter_ms = 1.0};
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  static_cast<void>(worst_ms(clock, device, 0, 400));
  for (const std::int64_t wrong_by_ms : {-4'000'000, -5000, -600, -30, 30, 600, 5000, 4'000'000}) {
    const auto counter_ms = static_cast<std::uint32_t>((device.counter_ms(400) + wrong_by_ms) & 0xFFFFFF);
    if (wrong_by_ms >= -600 && wrong_by_ms < -25) {
      continue;  // as if it had waited in a buffer
    }
    EXPECT_EQ(clock.host_ns(counter_ms, device.arrival_ns(400)).error(), Errc::kImplausibleStamp) << wrong_by_ms;
  }
  const Result<std::int64_t> stamp_ns = clock.host_ns(device.counter_ms(401), device.arrival_ns(401));
  ASSERT_TRUE(stamp_ns.ok());
  EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(401)), kMs);
  EXPECT_EQ(clock.resets(), 0U);
}

TEST(DeviceClock, ACounterThatStandsStillGivesWayToTheArrival) {
  Device device{.jitter_ms = 1.0};
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  static_cast<void>(worst_ms(clock, device, 0, 100));
  int refused = 0;
  for (int scan = 100; scan < 200; ++scan) {
    const Result<std::int64_t> stamp_ns = clock.host_ns(device.counter_ms(99), device.arrival_ns(scan));
    refused += stamp_ns.ok() ? 0 : 1;
    if (stamp_ns.ok()) {
      EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(scan)), 2 * kMs);
    }
  }
  EXPECT_EQ(refused, 2);
}

TEST(DeviceClock, ACounterThatStandsStillNowAndThenIsRefusedEachTime) {
  Device device;
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  for (int scan = 0; scan < 100; ++scan) {
    EXPECT_TRUE(clock.host_ns(device.counter_ms(scan), device.arrival_ns(scan)).ok());
    for (int again = 0; again < (scan % 10 == 9 ? 2 : 0); ++again) {
      EXPECT_FALSE(clock.host_ns(device.counter_ms(scan), device.arrival_ns(scan) + kMs).ok()) << scan;
    }
  }
}

TEST(DeviceClock, ScansThatWaitedInABufferKeepTheirTimes) {
  Device device;
  DeviceClock clock;
  clock.start(device.period_ns, kDelayNs);
  static_cast<void>(worst_ms(clock, device, 0, 400));
  for (int scan = 400; scan < 440; ++scan) {
    const Result<std::int64_t> stamp_ns = clock.host_ns(device.counter_ms(scan), device.true_ns(440) + kDelayNs);
    ASSERT_TRUE(stamp_ns.ok());
    EXPECT_LT(std::abs(stamp_ns.value() - device.true_ns(scan)), kMs);
  }
}

}  // namespace
}  // namespace odoless
