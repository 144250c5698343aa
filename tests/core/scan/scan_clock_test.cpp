#include "core/scan/scan_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/stamp_faults.hpp"

namespace odoless {
namespace {

using Stamps = std::vector<std::int64_t>;

constexpr std::int64_t kClockPeriod_ns = 197'000'000;
constexpr std::int64_t kFirst_ns = 1'282'836'370'000'000'000;
constexpr std::int64_t kYear_ns = 31'557'600'000'000'000;
constexpr int kScans = 13'631;

double to_s(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

struct Timed {
  std::vector<ScanTime> times;
  ScanTimeFindings findings;
};

Timed time_all(const Stamps& stamps_ns) {
  Timed out;
  ScanClock clock;
  for (const std::int64_t stamp_ns : stamps_ns) {
    out.times.push_back(clock.next(stamp_ns));
  }
  out.findings = clock.findings();
  return out;
}

bool times_grow(const std::vector<ScanTime>& times) {
  return std::adjacent_find(times.begin(), times.end(),
                            [](const ScanTime& a, const ScanTime& b) { return b.time_ns <= a.time_ns; }) == times.end();
}

/// What the times between scans are off by, from the scan `from` on.
struct Errors {
  std::vector<double> off_s;  ///< without signs, sorted
  double within_2_sd = 0.0;   ///< share

  [[nodiscard]] double quantile(double share) const {
    return off_s[static_cast<std::size_t>(share * static_cast<double>(off_s.size() - 1))];
  }
};

Errors errors_of(const std::vector<ScanTime>& times, const Stamps& true_ns, std::size_t from) {
  Errors errors;
  for (std::size_t i = std::max<std::size_t>(from, 1); i < times.size(); ++i) {
    const std::int64_t told_ns = times[i].time_ns - times[i - 1].time_ns;
    const double off_s = std::abs(to_s(told_ns - (true_ns[i] - true_ns[i - 1])));
    errors.off_s.push_back(off_s);
    errors.within_2_sd += off_s <= 2.0 * std::hypot(times[i].sd_s, times[i - 1].sd_s) ? 1.0 : 0.0;
  }
  errors.within_2_sd /= static_cast<double>(errors.off_s.size());
  std::sort(errors.off_s.begin(), errors.off_s.end());
  return errors;
}

TEST(ScanClock, GivesSteadyStampsAsTold) {
  for (const std::int64_t period_ns : {10'000'000LL, 25'000'000LL, 100'000'000LL, 440'000'000LL, 2'500'000'000LL}) {
    const Stamps stamps_ns = test::even_times(500, period_ns, kFirst_ns);
    const Timed timed = time_all(stamps_ns);
    for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
      ASSERT_EQ(timed.times[i].time_ns, stamps_ns[i]) << period_ns << " at " << i;
    }
    EXPECT_LT(timed.times.back().sd_s, 0.01 * to_s(period_ns));
    EXPECT_NEAR(timed.findings.period_s, to_s(period_ns), 1e-6);
    EXPECT_EQ(timed.findings.gaps, 0);
    EXPECT_EQ(timed.findings.out_of_order, 0);
  }
}

TEST(ScanClock, GivesStampsOfADeviceNearlyAsTold) {
  Rng rng(3);
  Stamps stamps_ns = test::even_times(3000, 25'000'000, kFirst_ns);
  for (std::int64_t& stamp_ns : stamps_ns) {
    stamp_ns += std::llround(500'000.0 * rng.normal());
  }
  const Timed timed = time_all(stamps_ns);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    ASSERT_LT(std::abs(to_s(timed.times[i].time_ns - stamps_ns[i])), 0.002) << i;
  }
  EXPECT_LE(timed.findings.doubtful, 2);
}

TEST(ScanClock, FollowsScansThatReallyComeUnevenly) {
  Rng rng(4);
  Stamps stamps_ns;
  std::int64_t now_ns = kFirst_ns;
  for (int i = 0; i < 2000; ++i) {
    now_ns += std::llround(1e9 * rng.uniform(0.1, 0.3));
    stamps_ns.push_back(now_ns);
  }
  const Errors errors = errors_of(time_all(stamps_ns).times, stamps_ns, 50);
  EXPECT_LT(errors.quantile(0.5), 0.015);
  EXPECT_LT(errors.quantile(0.95), 0.06);
}

TEST(ScanClock, SeesThroughStampsThatWaver) {
  const Stamps true_ns = test::even_times(kScans, kClockPeriod_ns, kFirst_ns);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Timed timed = time_all(test::waver(true_ns, seed));
    EXPECT_TRUE(times_grow(timed.times));
    const Errors errors = errors_of(timed.times, true_ns, 100);
    EXPECT_LT(errors.quantile(0.5), 0.005);
    EXPECT_LT(errors.quantile(0.99), 0.02);
    EXPECT_LT(errors.off_s.back(), 0.8) << "a late stamp that is taken for a gap";
    EXPECT_GT(errors.within_2_sd, 0.95);
    EXPECT_NEAR(timed.findings.period_s, 0.197, 0.004);
    EXPECT_EQ(timed.findings.gaps, 0);
    EXPECT_LT(timed.findings.doubtful, kScans / 4) << "those that are late, and no others";
  }
}

TEST(ScanClock, SpreadsBurstsEvenly) {
  const Stamps true_ns = test::even_times(5000, kClockPeriod_ns, kFirst_ns);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Timed timed = time_all(test::bunch(true_ns, 3, 10, seed));
    EXPECT_TRUE(times_grow(timed.times));
    const Errors errors = errors_of(timed.times, true_ns, 100);
    EXPECT_LT(errors.quantile(0.5), 0.02);
    EXPECT_LT(errors.quantile(0.95), 0.06);
    EXPECT_GT(errors.within_2_sd, 0.95);
    EXPECT_LE(timed.findings.gaps, 5) << "of some 770 bursts";
  }
}

// Scans are missing for 0.4 to 30 s, every 300 scans.
Stamps times_with_gaps(std::vector<std::size_t>& first_after) {
  constexpr std::array<double, 8> kGaps_s{0.4, 1.0, 2.0, 3.0, 4.0, 8.0, 12.0, 30.0};
  Stamps true_ns = test::even_times(300 * (static_cast<int>(kGaps_s.size()) + 1), kClockPeriod_ns, kFirst_ns);
  for (std::size_t gap = 0; gap < kGaps_s.size(); ++gap) {
    first_after.push_back(300 * (gap + 1));
    std::for_each(true_ns.begin() + static_cast<std::ptrdiff_t>(first_after.back()), true_ns.end(),
                  [&](std::int64_t& time_ns) { time_ns += std::llround(1e9 * kGaps_s[gap]); });
  }
  return true_ns;
}

TEST(ScanClock, KeepsGapsOfSteadyStamps) {
  std::vector<std::size_t> first_after;
  const Stamps stamps_ns = times_with_gaps(first_after);
  const Timed timed = time_all(stamps_ns);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    ASSERT_EQ(timed.times[i].time_ns, stamps_ns[i]) << i;
  }
  EXPECT_EQ(timed.findings.gaps, static_cast<std::int64_t>(first_after.size()));
  EXPECT_NEAR(timed.findings.longest_gap_s, 30.197, 0.001);
}

// Right after the jump it may be a late stamp: then the uncertainty covers the gap. Three scans later it is known.
TEST(ScanClock, KnowsAGapOfWaveringStampsWithinThreeScans) {
  std::vector<std::size_t> first_after;
  const Stamps true_ns = times_with_gaps(first_after);
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Stamps stamps_ns = test::waver(true_ns, seed);
    for (const std::size_t first : first_after) {  // the computer does not stall just then
      std::copy_n(true_ns.begin() + static_cast<std::ptrdiff_t>(first) - 5, 20,
                  stamps_ns.begin() + static_cast<std::ptrdiff_t>(first) - 5);
    }
    const std::vector<ScanTime> times = time_all(stamps_ns).times;
    EXPECT_TRUE(times_grow(times));
    for (const std::size_t first : first_after) {
      const double gap_s = to_s(true_ns[first] - true_ns[first - 1]);
      const double told_s = to_s(times[first].time_ns - times[first - 1].time_ns);
      EXPECT_LT(std::abs(told_s - gap_s), 4.0 * times[first].sd_s + 0.1) << gap_s << " seed " << seed;
      const double after_three_s = to_s(times[first + 3].time_ns - times[first - 1].time_ns);
      EXPECT_NEAR(after_three_s, to_s(true_ns[first + 3] - true_ns[first - 1]), 0.1) << gap_s << " seed " << seed;
      EXPECT_LT(times[first + 4].sd_s, 0.1) << gap_s << " seed " << seed;
    }
  }
}

TEST(ScanClock, AScanThatIsMissingIsAGapAndAStampThatIsLateIsNot) {
  Stamps true_ns = test::even_times(200, kClockPeriod_ns, kFirst_ns);
  Stamps late_ns = true_ns;
  late_ns[100] += 500'000'000;
  const Timed late = time_all(late_ns);
  EXPECT_EQ(late.findings.gaps, 0);
  EXPECT_NEAR(to_s(late.times[110].time_ns - true_ns[110]), 0.0, 0.001);
  EXPECT_GT(late.times[100].sd_s, 0.1);
  true_ns.erase(true_ns.begin() + 100, true_ns.begin() + 103);
  const Timed missing = time_all(true_ns);
  EXPECT_EQ(missing.findings.gaps, 1);
  EXPECT_NEAR(missing.findings.longest_gap_s, 4 * 0.197, 0.001);
}

struct Jump {
  const char* name;
  std::int64_t by_ns;
};
std::ostream& operator<<(std::ostream& out, const Jump& jump) { return out << jump.name; }

class ScanClockJump : public ::testing::TestWithParam<Jump> {};

// A clock that was set says nothing of the time that went by: the rhythm goes on, and the first scan is doubtful.
TEST_P(ScanClockJump, OfTheClockIsNoTime) {
  const Stamps true_ns = test::even_times(600, kClockPeriod_ns, kFirst_ns);
  Stamps stamps_ns = true_ns;
  std::for_each(stamps_ns.begin() + 300, stamps_ns.end(), [](std::int64_t& stamp_ns) { stamp_ns += GetParam().by_ns; });
  const Timed timed = time_all(stamps_ns);
  EXPECT_TRUE(times_grow(timed.times));
  EXPECT_EQ(timed.findings.clock_sets, 1);
  EXPECT_EQ(timed.findings.gaps, 0);
  for (std::size_t i = 0; i < true_ns.size(); ++i) {
    ASSERT_NEAR(to_s(timed.times[i].time_ns - true_ns[i]), 0.0, 0.02) << i;
  }
  EXPECT_LT(timed.times[305].sd_s, 0.05);
}

INSTANTIATE_TEST_SUITE_P(All, ScanClockJump,
                         ::testing::Values(Jump{"YearsForward", 50 * kYear_ns}, Jump{"YearsBack", -40 * kYear_ns},
                                           Jump{"HoursForward", 7'200'000'000'000},
                                           Jump{"TenSecondsBack", -10'000'000'000}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(ScanClock, ScansThatComeOnTimeTellAClockThatWasSetFromAGap) {
  ScanClock clock;
  ScanTime time;
  ScanTime before;
  for (int i = 0; i < 200; ++i) {
    before = time;
    const std::int64_t arrival_ns = 5'000'000'000 + i * kClockPeriod_ns;
    time = clock.next(kFirst_ns + i * kClockPeriod_ns + (i < 100 ? 0 : 10'000'000'000), arrival_ns);
    if (i > 0) {
      ASSERT_NEAR(to_s(time.time_ns - before.time_ns), 0.197, 0.03) << i;
    }
  }
  EXPECT_EQ(clock.findings().gaps, 0);
  EXPECT_EQ(clock.findings().clock_sets, 1);
}

TEST(ScanClock, CountsWhatItFinds) {
  const Stamps stamps_ns = test::waver(test::even_times(kScans, kClockPeriod_ns, kFirst_ns), 1);
  const test::StampCounts counts = test::count_stamps(stamps_ns);
  const ScanTimeFindings findings = time_all(stamps_ns).findings;
  EXPECT_EQ(findings.scans, kScans);
  EXPECT_EQ(findings.out_of_order, counts.out_of_order);
  EXPECT_GE(findings.bunched, counts.within_10_ms);
}

// Whatever the stamps are, times grow, and are never out of all proportion.
TEST(ScanClock, AnyStampsGiveTimesThatGrow) {
  Rng rng(9);
  for (int round = 0; round < 300; ++round) {
    ScanClock clock;
    std::int64_t stamp_ns = kFirst_ns;
    ScanTime before;
    for (int i = 0; i < 200; ++i) {
      const std::uint32_t kind = rng.below(10);
      const double step_s = kind < 5   ? 0.1
                            : kind < 7 ? rng.uniform(-1.0, 2.0)
                            : kind < 8 ? 0.0
                            : kind < 9 ? rng.uniform(-1e4, 1e4)
                                       : std::pow(10.0, rng.uniform(-9.0, 9.0)) * (rng.below(2) == 0 ? 1.0 : -1.0);
      stamp_ns += std::llround(step_s * 1e9);
      const ScanTime time = clock.next(stamp_ns);
      ASSERT_TRUE(std::isfinite(time.sd_s));
      ASSERT_GE(time.sd_s, 0.0);
      if (i > 0) {
        ASSERT_GT(time.time_ns, before.time_ns) << "round " << round << " scan " << i;
        ASSERT_LT(to_s(time.time_ns - before.time_ns), 7200.0) << "round " << round << " scan " << i;
      }
      before = time;
    }
  }
}

TEST(ScanClock, TheLargestStampsThereAreDoNoHarm) {
  constexpr std::int64_t kLeast_ns = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost_ns = std::numeric_limits<std::int64_t>::max();
  for (const Stamps& stamps_ns :
       {Stamps{kLeast_ns, kMost_ns, kLeast_ns, 0, kMost_ns, kMost_ns}, Stamps{kMost_ns, kMost_ns, kLeast_ns, 0}}) {
    for (const ScanTime& time : time_all(stamps_ns).times) {
      EXPECT_TRUE(std::isfinite(time.sd_s));
    }
  }
}

TEST(ScanClock, UsesNoHeap) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer owns the heap functions";
  }
  const Stamps stamps_ns = test::waver(test::even_times(2000, kClockPeriod_ns, kFirst_ns), 1);
  ScanClock clock;
  const AllocationGuard guard;
  for (const std::int64_t stamp_ns : stamps_ns) {
    static_cast<void>(clock.next(stamp_ns));
  }
  EXPECT_EQ(guard.calls(), 0);
}

TEST(StampFaults, WaverAsThoseOfARecordedOffice) {
  const test::StampCounts counts = test::count_stamps(test::waver(test::even_times(kScans, kClockPeriod_ns), 1));
  EXPECT_NEAR(counts.out_of_order, 631, 60);
  EXPECT_NEAR(counts.within_10_ms, 3762, 380);
  EXPECT_NEAR(counts.gaps_above_1_s, 420, 60);
  EXPECT_NEAR(counts.most_back_s, 0.6, 0.1);
}

}  // namespace
}  // namespace odoless
