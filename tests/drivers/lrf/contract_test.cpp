// What every laser's driver owes, whatever its protocol: each against an emulated laser.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/drivers/lrf/answered_line.hpp"
#include "tests/drivers/lrf/tested_lasers.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;

constexpr std::int64_t kBroughtUpNs = 12 * kSecond;  ///< at most, searches for the rate included
constexpr std::int64_t kFaultNs = 1500 * kMs;
constexpr double kWrongShareMax = 0.05;  ///< of a scan's beams: at an edge, one may see either surface
constexpr int kLostPerOutageMax = 3;     ///< that it stalled, that it is silent, and that no rate helps
constexpr double kRangeErrorMaxM = 0.05;

WorldDrive standing_robot(double sees_to_m) {
  constexpr const char* kRoom = "room 0 0  7 4\nbox 5 3  1 0.6\nspeed 0.01\ngo 2 1.6  2.01 1.6\n";
  constexpr const char* kCloset = "room 0 0  4 3\nbox 3 2.2  0.5 0.4\nspeed 0.01\ngo 1.5 1.4  1.51 1.4\n";
  WorldDrive drive;
  drive.world = parse_world(sees_to_m < 6.0 ? kCloset : kRoom, "standing");
  drive.noise_sd_m = 0.0;
  return drive;
}

/// Brings the laser to its stream, and holds what is heard from then on to the world: it stands, so that all scans
/// are alike.
class LrfContract : public ::testing::TestWithParam<test::TestedLaser> {
 protected:
  LrfContract() : LrfContract(GetParam().params()) {}
  explicit LrfContract(const LrfParams& params)
      : bench_(GetParam().model, {}, params, standing_robot(GetParam().sees_to_m)) {}

  void bring_up() {
    bench_.reset();
    run_until_scans(3, kBroughtUpNs);
    ASSERT_TRUE(bench_.session().ready());
  }

  void run_until_scans(std::size_t more, std::int64_t at_most_ns) {
    const std::size_t wanted = scans() + more;
    for (const std::int64_t end_ns = bench_.now_ns() + at_most_ns; scans() < wanted && bench_.now_ns() < end_ns;) {
      bench_.run(5 * kMs);
    }
    ASSERT_GE(scans(), wanted) << "in " << static_cast<double>(at_most_ns) * 1e-9 << " s";
  }

  [[nodiscard]] std::size_t scans() const { return bench_.heard().scans.size(); }

  /// From a scan's stamp to the nearest time at which the laser began one.
  [[nodiscard]] std::int64_t stamp_error_ns(std::size_t scan) const {
    std::int64_t least_ns = kSecond;
    for (const SentScan& sent : bench_.sent()) {
      least_ns = std::min(least_ns, std::abs(sent.first_beam_ns - bench_.heard().scans[scan].stamp_ns));
    }
    return least_ns;
  }

  /// The share of beams of which something else is said than what is there, or nothing.
  [[nodiscard]] double wrong_share(const test::HeardScan& scan) {
    std::vector<EmulatedBeam> beams;
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      beams.push_back({scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad, 0});
    }
    std::vector<double> true_m(beams.size());
    bench_.source().measure(0, beams, true_m);
    const auto is_wrong = [](float range_m, double is_m) {
      return range_m != 0.0F && !(std::abs(static_cast<double>(range_m) - is_m) < kRangeErrorMaxM);
    };
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < true_m.size(); ++i) {
      wrong += is_wrong(scan.ranges_m[i], true_m[i]) ? 1U : 0U;
    }
    return static_cast<double>(wrong) / static_cast<double>(true_m.size());
  }

  void expect_no_wrong_scan() {
    std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
    for (const test::HeardScan& scan : bench_.heard().scans) {
      ASSERT_LT(wrong_share(scan), kWrongShareMax) << "at " << scan.stamp_ns;
      ASSERT_GT(scan.stamp_ns, last_ns);
      ASSERT_LE(scan.stamp_ns, scan.arrival_ns);
      last_ns = scan.stamp_ns;
    }
  }

  /// For a while, what the laser sends is another; then it streams again within a few seconds.
  void expect_survived(std::function<void(std::string&)> damage) {
    bring_up();
    const int told_before = bench_.heard().count(LrfEventType::kLost);
    bench_.on_the_way = std::move(damage);
    bench_.run(kFaultNs);
    bench_.on_the_way = [](std::string&) {};
    run_until_scans(5, kBroughtUpNs);
    EXPECT_LE(bench_.heard().count(LrfEventType::kLost) - told_before, kLostPerOutageMax);
    expect_no_wrong_scan();
  }

  Bench bench_;
  Rng rng_{17};
};

TEST_P(LrfContract, StreamsWhatIsThere) {
  bring_up();
  run_until_scans(10, kBroughtUpNs);
  expect_no_wrong_scan();
  EXPECT_EQ(bench_.heard().count(LrfEventType::kReady), 1);
  EXPECT_EQ(bench_.heard().events.back().type, LrfEventType::kReady) << "and then nothing to tell";
  EXPECT_EQ(bench_.session().counters().scans, scans());
}

TEST_P(LrfContract, ItsGeometryIsThatOfItsScans) {
  bring_up();
  run_until_scans(20, kBroughtUpNs);
  const LrfGeometry& geometry = bench_.session().geometry();
  const std::vector<test::HeardScan>& heard = bench_.heard().scans;
  for (const test::HeardScan& scan : heard) {
    ASSERT_EQ(scan.ranges_m.size(), static_cast<std::size_t>(geometry.beams));
    ASSERT_EQ(scan.start_angle_rad, geometry.start_angle_rad);
    ASSERT_EQ(scan.angle_step_rad, geometry.angle_step_rad);
    for (const float range_m : scan.ranges_m) {
      ASSERT_TRUE(range_m == 0.0F || range_m >= geometry.range_min_m);
      ASSERT_TRUE(std::isinf(range_m) || range_m <= geometry.range_max_m);
    }
  }
  EXPECT_GT(geometry.range_max_m, 3.0);
  EXPECT_LE(geometry.range_max_m, 100.0);
  const std::int64_t took_ns = heard.back().stamp_ns - heard[heard.size() - 11].stamp_ns;
  EXPECT_NEAR(static_cast<double>(geometry.period_ns), static_cast<double>(took_ns) / 10.0,
              0.05 * static_cast<double>(geometry.period_ns));
}

/// By which a laser that repeats itself is found: how many of the last scans in a row were those before them.
TEST_P(LrfContract, CountsScansThatAreThoseBeforeThem) {
  bring_up();
  const auto is_repeated = [&](std::size_t scan) {
    const std::vector<test::HeardScan>& heard = bench_.heard().scans;
    return scan > 0 && heard[scan].ranges_m == heard[scan - 1].ranges_m;
  };
  for (int more = 0; more < 20; ++more) {
    run_until_scans(1, kBroughtUpNs);
    std::uint64_t repeated = 0;
    std::uint64_t in_a_row = 0;
    for (std::size_t scan = 0; scan < scans(); ++scan) {
      repeated += is_repeated(scan) ? 1 : 0;
      in_a_row = is_repeated(scan) ? in_a_row + 1 : 0;
    }
    ASSERT_EQ(bench_.session().counters().identical, repeated);
    ASSERT_EQ(bench_.session().counters().identical_run, in_a_row);
  }
  const std::size_t before = scans();
  bench_.reset();
  run_until_scans(3, kBroughtUpNs);
  EXPECT_LE(bench_.session().counters().identical_run, scans() - before) << "of a line that was opened anew";
}

TEST_P(LrfContract, StampsAreTrueFromTheFirstScanOn) {
  bring_up();
  run_until_scans(10, kBroughtUpNs);
  for (std::size_t i = 0; i < scans(); ++i) {
    EXPECT_LT(stamp_error_ns(i), 3 * kMs) << i;
  }
}

// A quarter of a second is missing, which is no whole number of turns of most.
TEST_P(LrfContract, StampsAreTrueAgainSoonAfterSomethingWasLost) {
  bring_up();
  bench_.run(2 * kSecond);
  bench_.on_the_way = [](std::string& bytes) { bytes.clear(); };
  bench_.run(270 * kMs);
  bench_.on_the_way = [](std::string&) {};
  bench_.run(kSecond);
  const std::size_t first = scans();
  run_until_scans(5, kBroughtUpNs);
  for (std::size_t i = first; i < scans(); ++i) {
    EXPECT_LT(stamp_error_ns(i), 3 * kMs) << i;
  }
}

// Where a byte is missing, the next ones still tell when they were measured: by a count, an angle, or the time they
// took.
TEST_P(LrfContract, AMissingByteMovesNoStamp) {
  bring_up();
  bench_.run(2 * kSecond);
  for (int fault = 0; fault < 10; ++fault) {
    bool is_missing = false;
    bench_.on_the_way = [&](std::string& bytes) {
      if (!bytes.empty() && !std::exchange(is_missing, true)) {
        bytes.erase(rng_.below(static_cast<std::uint32_t>(bytes.size())), 1);
      }
    };
    const std::size_t first = scans();
    run_until_scans(3, kBroughtUpNs);
    for (std::size_t i = first; i < scans(); ++i) {
      EXPECT_LT(stamp_error_ns(i), 3 * kMs) << i;
    }
    bench_.run(97 * kMs);
  }
}

TEST_P(LrfContract, IsTakenOverWhileItStreams) {
  bring_up();
  const int told_before = bench_.heard().count(LrfEventType::kLost);
  for (int opened = 1; opened <= 3; ++opened) {
    bench_.run(37 * kMs);
    bench_.reset();
    EXPECT_FALSE(bench_.session().ready());
    run_until_scans(3, kBroughtUpNs);
    EXPECT_EQ(bench_.session().counters().restarts, static_cast<std::uint64_t>(opened));
    EXPECT_EQ(bench_.heard().count(LrfEventType::kReady), opened + 1);
  }
  EXPECT_EQ(bench_.heard().count(LrfEventType::kLost), told_before);
  EXPECT_EQ(bench_.heard().count(LrfEventType::kDeviceError), 0);
  EXPECT_EQ(bench_.heard().count(LrfEventType::kUnanswered), 0);
  expect_no_wrong_scan();
}

TEST_P(LrfContract, TellsOnceEachTimeItIsOpenedThatNobodyAnswers) {
  bench_.device().set_power(false, bench_.now_ns());
  for (int opened = 1; opened <= 2; ++opened) {
    bench_.reset();
    bench_.run(8 * kSecond);
    EXPECT_EQ(bench_.heard().count(LrfEventType::kLost), opened);
    EXPECT_EQ(bench_.heard().events.back().reason, Errc::kDeviceSilent);
  }
  EXPECT_EQ(bench_.heard().events.size(), 2U);
  EXPECT_EQ(bench_.session().counters().restarts, 1U);
}

TEST_P(LrfContract, RefusesALaserWithMoreBeamsThanThereIsRoomFor) {
  bring_up();
  const int beams = bench_.session().geometry().beams;
  test::AnsweredLine enough(GetParam().model, GetParam().params(), {}, beams);
  test::AnsweredLine too_few(GetParam().model, GetParam().params(), {}, beams - 1);
  for (test::AnsweredLine* const line : {&enough, &too_few}) {
    line->reset();
    line->run(8 * kSecond);
  }
  EXPECT_TRUE(enough.session().ready());
  EXPECT_FALSE(too_few.session().ready());
  EXPECT_TRUE(too_few.heard().scans.empty());
  const bool is_told = std::ranges::any_of(too_few.heard().events,
                                           [](const LrfEvent& event) { return event.reason == Errc::kTooManyBeams; });
  EXPECT_TRUE(is_told);
}

TEST_P(LrfContract, IsUnpluggedAndPluggedInAgain) {
  bring_up();
  for (int outage = 1; outage <= 2; ++outage) {
    const int told_before = bench_.heard().count(LrfEventType::kLost);
    bench_.device().set_power(false, bench_.now_ns());
    bench_.run(3 * kSecond);
    const std::size_t before = scans();
    bench_.run(kSecond);
    EXPECT_EQ(scans(), before) << "of a laser that is not there";
    const int told = bench_.heard().count(LrfEventType::kLost) - told_before;
    EXPECT_GE(told, 1);
    EXPECT_LE(told, kLostPerOutageMax) << "of a whole outage";
    bench_.device().set_power(true, bench_.now_ns());
    bench_.reset();  // its line was opened again
    run_until_scans(5, kBroughtUpNs);
  }
  expect_no_wrong_scan();
}

TEST_P(LrfContract, HearsNothingInGarbage) {
  expect_survived([&](std::string& bytes) {
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(rng_.below(256)); });
  });
}

TEST_P(LrfContract, TellsOfNoiseEachTimeButNotOfEachByte) {
  test::AnsweredLine line(GetParam().model, GetParam().params());
  line.reset();
  line.run(kBroughtUpNs);
  ASSERT_TRUE(line.session().ready());
  const std::size_t before = line.heard().events.size();
  const auto told_after_noise = [&] {
    line.say(std::string(5000, '\x55'));
    line.run(2 * kSecond);
    return line.heard().events.size() - before;
  };
  const std::size_t told = told_after_noise();
  EXPECT_GE(told, 1U);
  EXPECT_LE(told, 2U) << "that a scan was spoilt, and that bytes were left out";
  EXPECT_EQ(told_after_noise(), 2 * told);
  for (const LrfEvent& event : std::span(line.heard().events).subspan(before)) {
    EXPECT_TRUE(event.type == LrfEventType::kResync || event.type == LrfEventType::kRejected);
    EXPECT_NE(event.reason, Errc::kWrongSum) << "of a frame that there was none of";
  }
}

TEST_P(LrfContract, HearsNothingInHalfPackets) {
  expect_survived([](std::string& bytes) { bytes.resize(bytes.size() / 2); });
}

TEST_P(LrfContract, HearsNothingWrongInBytesThatAreMissing) {
  expect_survived([&](std::string& bytes) {
    if (!bytes.empty() && rng_.below(4) == 0) {
      const std::size_t first = rng_.below(static_cast<std::uint32_t>(bytes.size()));
      bytes.erase(first, 1 + rng_.below(3));
    }
  });
}

TEST_P(LrfContract, HearsNothingWrongInBytesThatAreOthers) {
  if (!GetParam().has_sums) {
    GTEST_SKIP() << "its protocol has no check sums";
  }
  expect_survived([&](std::string& bytes) {
    for (char& byte : bytes) {
      byte = rng_.below(20) == 0 ? static_cast<char>(rng_.below(256)) : byte;
    }
  });
  const LrfCounters& counters = bench_.session().counters();
  EXPECT_GT(counters.rejected + counters.resyncs, 0U) << "and says so";
  EXPECT_GT(bench_.heard().count(LrfEventType::kRejected) + bench_.heard().count(LrfEventType::kResync), 0);
}

TEST_P(LrfContract, NeverSpins) {
  bring_up();
  bench_.device().set_power(false, bench_.now_ns());
  for (int i = 0; i < 4000; ++i) {
    bench_.run(kMs);
    ASSERT_GT(bench_.session().next_deadline_ns(), bench_.now_ns() - kMs);
  }
}

/// Of those that do not search where a rate is set.
class LrfAtAWrongRate : public LrfContract {
 protected:
  static LrfParams wrong_params() {
    LrfParams params = GetParam().params();
    params.baud = GetParam().wrong_baud;
    return params;
  }
  LrfAtAWrongRate() : LrfContract(wrong_params()) {}
};

TEST_P(LrfAtAWrongRate, SaysThatNoLaserAnswersAndHearsNoScan) {
  bench_.reset();
  bench_.run(8 * kSecond);
  EXPECT_FALSE(bench_.session().ready());
  EXPECT_EQ(scans(), 0U);
  EXPECT_GE(bench_.heard().count(LrfEventType::kLost), 1);
  EXPECT_LE(bench_.heard().count(LrfEventType::kLost), kLostPerOutageMax);
  EXPECT_EQ(bench_.session().line_baud(), GetParam().wrong_baud);
}

std::vector<test::TestedLaser> lasers_that_keep_a_rate() {
  std::vector<test::TestedLaser> lasers;
  std::ranges::copy_if(test::kTestedLasers, std::back_inserter(lasers),
                       [](const test::TestedLaser& laser) { return laser.wrong_baud != 0; });
  return lasers;
}

INSTANTIATE_TEST_SUITE_P(Lasers, LrfContract, ::testing::ValuesIn(test::kTestedLasers),
                         [](const auto& tested) { return test::laser_name(tested); });
INSTANTIATE_TEST_SUITE_P(Lasers, LrfAtAWrongRate, ::testing::ValuesIn(lasers_that_keep_a_rate()),
                         [](const auto& tested) { return test::laser_name(tested); });

}  // namespace
}  // namespace odoless
