// Each fault does to the stream of scans what tools/fault_campaign/README.md says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "tools/fault_campaign/faults.hpp"
#include "tools/sim/ray_caster.hpp"

namespace odoless::campaign {
namespace {

constexpr double kSlack_s = 0.02;  // scans that wait are read some milliseconds apart

struct Streams {
  Scenario scenario;
  ScanStream clean;
  ScanStream faulty;
};

Streams streams_of(FaultKind kind, int index, double severity = 0.0, int variant = -1) {
  Scenario scenario = draw_scenario(2, index, kind);
  scenario.fault.severity = severity > 0.0 ? severity : scenario.fault.severity;
  scenario.fault.variant = variant >= 0 ? variant : scenario.fault.variant;
  const Drive drive(scenario);
  Streams out{scenario, clean_stream(scenario, drive), {}};
  out.faulty = out.clean;
  apply_fault(scenario, out.faulty);
  return out;
}

bool is_clean(const SentScan& scan, const SentScan& clean) {
  return scan.true_s == clean.true_s && scan.stamp_ns == clean.stamp_ns && scan.arrival_ns == clean.arrival_ns &&
         scan.ranges_m == clean.ranges_m;
}

const SentScan& clean_of(const Streams& streams, const SentScan& scan) {
  return *std::ranges::find(streams.clean.scans, scan.true_s, &SentScan::true_s);
}

double late_s(const SentScan& scan) { return since_start_s(scan.arrival_ns) - scan.true_s; }
double stamp_off_s(const SentScan& scan) { return since_start_s(scan.stamp_ns) - scan.true_s; }

/// Beams of a scan that are not the clean one's.
double changed_share(const SentScan& scan, const SentScan& clean) {
  int changed = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    changed += scan.ranges_m[i] != clean.ranges_m[i] ? 1 : 0;
  }
  return static_cast<double>(changed) / static_cast<double>(scan.ranges_m.size());
}

/// Scans that are not the fault's are as they were, and every one is there.
void expect_clean_outside(const Streams& streams) {
  std::size_t outside = 0;
  for (const SentScan& scan : streams.faulty.scans) {
    if (!streams.scenario.fault.active(scan.true_s)) {
      ++outside;
      ASSERT_TRUE(is_clean(scan, clean_of(streams, scan))) << scan.true_s;
    }
  }
  EXPECT_EQ(outside, std::ranges::count_if(streams.clean.scans, [&](const SentScan& scan) {
              return !streams.scenario.fault.active(scan.true_s);
            }));
}

void for_each_active(const Streams& streams, const std::function<void(const SentScan&, const SentScan&)>& look) {
  int seen = 0;
  for (const SentScan& scan : streams.faulty.scans) {
    if (streams.scenario.fault.active(scan.true_s)) {
      ++seen;
      look(scan, clean_of(streams, scan));
    }
  }
  EXPECT_GT(seen, 5);
}

TEST(CampaignFaults, ArriveInOrderWhateverHappens) {
  for (const FaultSpec& spec : fault_specs()) {
    for (int i = 0; i < 3; ++i) {
      const Streams streams = streams_of(spec.kind, i);
      EXPECT_TRUE(std::ranges::is_sorted(streams.faulty.scans, {}, &SentScan::arrival_ns)) << spec.name;
      EXPECT_TRUE(std::ranges::is_sorted(streams.faulty.scans, {}, &SentScan::true_s)) << spec.name;
      EXPECT_GT(streams.faulty.scans.size(), streams.clean.scans.size() / 2) << spec.name;
    }
  }
}

TEST(CampaignFaults, NoneIsAStreamWithoutFault) {
  const Streams streams = streams_of(FaultKind::kNone, 0);
  for (std::size_t i = 0; i < streams.clean.scans.size(); ++i) {
    ASSERT_TRUE(is_clean(streams.faulty.scans[i], streams.clean.scans[i]));
  }
}

TEST(CampaignFaults, SilenceHasNoScan) {
  const Streams streams = streams_of(FaultKind::kSilence, 1);
  expect_clean_outside(streams);
  EXPECT_TRUE(std::ranges::none_of(streams.faulty.scans,
                                   [&](const SentScan& scan) { return streams.scenario.fault.active(scan.true_s); }));
}

TEST(CampaignFaults, GapsAreAsLongAsSaidAndHaveScansBetween) {
  const Streams streams = streams_of(FaultKind::kGaps, 1, 1.0);
  expect_clean_outside(streams);
  const double period_s = streams.clean.scans[1].true_s;
  double longest_s = 0.0;
  int gaps = 0;
  for (std::size_t i = 1; i < streams.faulty.scans.size(); ++i) {
    const double step_s = streams.faulty.scans[i].true_s - streams.faulty.scans[i - 1].true_s;
    longest_s = std::max(longest_s, step_s);
    gaps += step_s > 1.5 * period_s ? 1 : 0;
  }
  EXPECT_GE(gaps, 2);
  EXPECT_LE(longest_s, 1.0 + period_s + 1e-9);
  EXPECT_GE(longest_s, 1.0);
}

TEST(CampaignFaults, DelayMakesScansLateAndLeavesTheirStamps) {
  const Streams streams = streams_of(FaultKind::kDelay, 1, 0.8);
  for_each_active(streams, [](const SentScan& scan, const SentScan& clean) {
    EXPECT_NEAR(late_s(scan), 0.8, kSlack_s);
    EXPECT_EQ(scan.stamp_ns, clean.stamp_ns);
    EXPECT_EQ(scan.ranges_m, clean.ranges_m);
  });
  EXPECT_EQ(streams.faulty.scans.size(), streams.clean.scans.size());
  EXPECT_TRUE(is_clean(streams.faulty.scans.back(), streams.clean.scans.back()));
}

TEST(CampaignFaults, JitterStampsScansWhenTheyArrive) {
  const Streams streams = streams_of(FaultKind::kJitter, 1, 0.5);
  double most_s = 0.0;
  double least_s = 1.0;
  for_each_active(streams, [&](const SentScan& scan, const SentScan&) {
    EXPECT_EQ(scan.stamp_ns, scan.arrival_ns);
    EXPECT_GE(late_s(scan), 0.0);
    EXPECT_LE(late_s(scan), 0.5 + kSlack_s);
    most_s = std::max(most_s, late_s(scan));
    least_s = std::min(least_s, late_s(scan));
  });
  EXPECT_GT(most_s, 0.35);
  EXPECT_LT(least_s, 0.15);
}

TEST(CampaignFaults, BurstsBringSoManyAtOnceStampedAsTheyArrive) {
  const Streams streams = streams_of(FaultKind::kBursts, 1, 4.0);
  std::map<std::int64_t, int> size_of_burst;  // by the time in 0.1 s
  for_each_active(streams, [&](const SentScan& scan, const SentScan&) {
    EXPECT_EQ(scan.stamp_ns, scan.arrival_ns);
    ++size_of_burst[(scan.arrival_ns - kStart_ns + 20'000'000) / 100'000'000];
  });
  const auto full = std::ranges::count_if(size_of_burst, [](const auto& burst) { return burst.second == 4; });
  EXPECT_GE(full + 1, static_cast<std::ptrdiff_t>(size_of_burst.size()));  // but the last
}

TEST(CampaignFaults, WaveringStampsStickAndGoBackWithinTheirBound) {
  const Streams streams = streams_of(FaultKind::kWavering, 1, 0.6);
  int back = 0;
  int sticking = 0;
  for (std::size_t i = 1; i < streams.faulty.scans.size(); ++i) {
    const SentScan& scan = streams.faulty.scans[i];
    EXPECT_EQ(scan.arrival_ns, host_ns(scan.true_s));
    const double step_s = 1e-9 * static_cast<double>(scan.stamp_ns - streams.faulty.scans[i - 1].stamp_ns);
    back += step_s < 0.0 ? 1 : 0;
    sticking += step_s > 0.0 && step_s < 0.011 ? 1 : 0;
    EXPECT_GE(step_s, -0.9);
  }
  const auto all = static_cast<double>(streams.faulty.scans.size());
  EXPECT_GT(back / all, 0.02);
  EXPECT_LT(back / all, 0.15);
  EXPECT_GT(sticking / all, 0.2);
  EXPECT_LT(sticking / all, 0.4);
}

TEST(CampaignFaults, JumpingStampsAreAllOffByOneJump) {
  Streams streams = streams_of(FaultKind::kJumping, 1);
  expect_clean_outside(streams);
  for_each_active(streams, [&](const SentScan& scan, const SentScan& clean) {
    EXPECT_NEAR(stamp_off_s(scan), streams.scenario.fault.severity, 1e-3 + 1e-6 * std::abs(stamp_off_s(scan)));
    EXPECT_EQ(scan.arrival_ns, clean.arrival_ns);
  });
}

TEST(CampaignFaults, AStuckLaserShowsItsLastScanButForSomeBeams) {
  const Streams streams = streams_of(FaultKind::kStuck, 1, 0.1);
  expect_clean_outside(streams);
  const auto first = std::ranges::find_if(
      streams.clean.scans, [&](const SentScan& scan) { return streams.scenario.fault.active(scan.true_s); });
  double changed = 0.0;
  int scans = 0;
  for_each_active(streams, [&](const SentScan& scan, const SentScan&) {
    changed += changed_share(scan, *(first - 1));
    ++scans;
  });
  EXPECT_NEAR(changed / scans, 0.1, 0.05);
}

TEST(CampaignFaults, AStuckLaserWithNoiseStaysWithinIt) {
  const Streams streams = streams_of(FaultKind::kStuckNoise, 1, 0.003);
  const auto first = std::ranges::find_if(
      streams.clean.scans, [&](const SentScan& scan) { return streams.scenario.fault.active(scan.true_s); });
  for_each_active(streams, [&](const SentScan& scan, const SentScan&) {
    EXPECT_GT(changed_share(scan, *(first - 1)), 0.9);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (std::isfinite(scan.ranges_m[i])) {
        EXPECT_NEAR(scan.ranges_m[i], (first - 1)->ranges_m[i], 5.5 * 0.003);
      }
    }
  });
}

TEST(CampaignFaults, CorruptRangesAreAnythingForAShareOfBeams) {
  const Streams streams = streams_of(FaultKind::kCorrupt, 1, 0.3);
  expect_clean_outside(streams);
  for_each_active(
      streams, [](const SentScan& scan, const SentScan& clean) { EXPECT_NEAR(changed_share(scan, clean), 0.3, 0.15); });
}

TEST(CampaignFaults, ADeadSectorIsOnePieceAndShowsNothingOrDirt) {
  for (const int variant : {0, 1}) {
    const Streams streams = streams_of(FaultKind::kDeadSector, 1, 0.4, variant);
    expect_clean_outside(streams);
    for_each_active(streams, [&](const SentScan& scan, const SentScan& clean) {
      EXPECT_LE(changed_share(scan, clean), 0.4 + 1e-9);
      const float shown_m = *std::ranges::min_element(scan.ranges_m);
      const auto dead = std::ranges::count_if(
          scan.ranges_m, [&](float range_m) { return variant == 0 ? std::isinf(range_m) : range_m == shown_m; });
      EXPECT_GE(static_cast<double>(dead), 0.39 * static_cast<double>(scan.ranges_m.size()));
      EXPECT_TRUE(variant == 0 || shown_m <= 0.4F);
    });
  }
}

TEST(CampaignFaults, ACrowdOnlyHidesWhatIsBehindIt) {
  const Streams streams = streams_of(FaultKind::kCrowd, 1, 10.0);
  expect_clean_outside(streams);
  double hidden = 0.0;
  int scans = 0;
  for_each_active(streams, [&](const SentScan& scan, const SentScan& clean) {
    hidden += changed_share(scan, clean);
    ++scans;
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      EXPECT_LE(scan.ranges_m[i], clean.ranges_m[i]);
    }
  });
  EXPECT_GT(hidden / scans, 0.1);
  EXPECT_LT(hidden / scans, 0.9);
}

TEST(CampaignFaults, ScaledRangesAreAllLongerOrShorter) {
  const Streams streams = streams_of(FaultKind::kScaled, 1, 1.5);
  expect_clean_outside(streams);
  for_each_active(streams, [](const SentScan& scan, const SentScan& clean) {
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      EXPECT_EQ(scan.ranges_m[i], 1.5F * clean.ranges_m[i]);
    }
  });
}

TEST(CampaignFaults, ALaserUpsideDownSeesFromTheOtherSide) {
  const Streams streams = streams_of(FaultKind::kUpsideDown, 1);
  expect_clean_outside(streams);
  for_each_active(streams, [](const SentScan& scan, const SentScan& clean) {
    EXPECT_TRUE(std::equal(scan.ranges_m.begin(), scan.ranges_m.end(), clean.ranges_m.rbegin()));
  });
}

// The mirror image's truth: what is seen from the mirrored pose in the mirrored world.
TEST(CampaignFaults, AMirroredRunHasAMirroredTruth) {
  Scenario scenario = draw_scenario(2, 1, FaultKind::kMirrored);
  const Drive mirrored(scenario);
  scenario.fault.kind = FaultKind::kNone;
  const Drive plain(scenario);
  const Pose2 seen = mirrored.start_T_robot(17.0);
  const Pose2 truth = plain.start_T_robot(17.0);
  EXPECT_EQ(seen.x_m, truth.x_m);
  EXPECT_EQ(seen.y_m, -truth.y_m);
  EXPECT_EQ(seen.yaw_rad, -truth.yaw_rad);
  EXPECT_GT(std::abs(truth.y_m) + std::abs(truth.yaw_rad), 0.0);
}

/// The longest way from one scan to the next, and when.
std::pair<double, double> longest_step(const Drive& drive, const ScanStream& stream) {
  double step_m = 0.0;
  double at_s = 0.0;
  for (std::size_t i = 1; i < stream.scans.size(); ++i) {
    const double true_s = stream.scans[i].true_s;
    const double way_m = drive.at(true_s).distance_m(drive.at(stream.scans[i - 1].true_s));
    at_s = way_m > step_m ? true_s : at_s;
    step_m = std::max(step_m, way_m);
  }
  return {step_m, at_s};
}

TEST(CampaignFaults, AKidnappedRobotIsCarriedOnceAndWandersOnClearOfEverything) {
  for (const FaultKind kind : {FaultKind::kKidnapping, FaultKind::kSymmetric}) {
    Scenario scenario = draw_scenario(2, 1, kind);
    scenario.fault.variant = 1;
    scenario.fault.severity = 3.0;
    const Drive drive(scenario);
    ASSERT_TRUE(drive.was_carried());
    const ScanStream stream = clean_stream(scenario, drive);
    const auto [step_m, at_s] = longest_step(drive, stream);
    EXPECT_NEAR(step_m, 3.0, 0.5);
    EXPECT_NEAR(at_s, scenario.fault.start_s, 0.25);
    for (double time_s = scenario.fault.start_s; time_s < scenario.duration_s; time_s += 0.5) {
      const Pose2 robot = drive.at(time_s);
      for (double angle_rad = 0.0; angle_rad < 6.28; angle_rad += 0.1) {
        EXPECT_GT(cast_ray_m(drive.world(), {robot.x_m, robot.y_m}, {std::cos(angle_rad), std::sin(angle_rad)}), 0.05);
      }
    }
  }
}

TEST(CampaignFaults, APlaceToCarryARobotToIsFound) {
  for (const FaultKind kind : {FaultKind::kKidnapping, FaultKind::kSymmetric}) {
    for (int i = 0; i < 20; ++i) {
      Scenario scenario = draw_scenario(4, i, kind);
      scenario.fault.variant = 1;
      EXPECT_TRUE(Drive(scenario).was_carried()) << describe(scenario);
    }
  }
}

TEST(CampaignFaults, ACorridorHidesItsEnds) {
  const Streams streams = streams_of(FaultKind::kCorridor, 1, 5.0, 0);
  for (const SentScan& scan : streams.faulty.scans) {
    for (const float range_m : scan.ranges_m) {
      EXPECT_TRUE(range_m < 5.0F || std::isinf(range_m));
    }
  }
}

TEST(CampaignFaults, AStoppedProcessReadsAtOnceWhatItsLineKept) {
  for (const int variant : {0, 1}) {
    const Streams streams = streams_of(FaultKind::kProcessStop, 1, 3.0, variant);
    const Fault& fault = streams.scenario.fault;
    int kept = 0;
    for (const SentScan& scan : streams.faulty.scans) {
      if (fault.active(scan.true_s)) {
        ++kept;
        EXPECT_NEAR(since_start_s(scan.arrival_ns), fault.end_s, kSlack_s);
        EXPECT_EQ(scan.stamp_ns, variant == 1 ? scan.arrival_ns : clean_of(streams, scan).stamp_ns);
      }
    }
    EXPECT_EQ(kept, 3);
    EXPECT_EQ(standstill_of(streams.scenario).from_s, fault.start_s);
    EXPECT_EQ(standstill_of(streams.scenario).until_s, fault.end_s);
  }
}

}  // namespace
}  // namespace odoless::campaign
