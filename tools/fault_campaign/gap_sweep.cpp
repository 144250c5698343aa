#include "tools/fault_campaign/gap_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/grid/occupancy_map.hpp"
#include "core/math/elementary.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless::campaign {
namespace {

constexpr std::array<double, GapSweep::kLengths> kGaps_s{1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0};
constexpr double kWatched_s = 15.0;  // after the gap

struct SweptWorld {
  const char* name;
  double first_s;  // gap
  double last_s;
};
// From where the map has something, to where the path goes on for long enough.
constexpr std::array<SweptWorld, 2> kSwept{{{"rooms", 8.0, 44.0}, {"office", 30.0, 240.0}}};

/// Share of a scan's returns that end within two cells of something that the map has, from where the robot truly is.
double known_share(const OccupancyMap& map, const ScanStream& stream, const SentScan& scan, const Pose2& map_T_scan) {
  constexpr int kAround_cells = 2;
  constexpr int kOccupied_percent = 50;
  const auto has_something = [&](const Point2& p_map) {
    const int column = static_cast<int>(std::floor((p_map.x_m - map.origin_x_m) / map.resolution_m));
    const int row = static_cast<int>(std::floor((p_map.y_m - map.origin_y_m) / map.resolution_m));
    for (int r = std::max(0, row - kAround_cells); r <= std::min(map.height_cells - 1, row + kAround_cells); ++r) {
      for (int c = std::max(0, column - kAround_cells); c <= std::min(map.width_cells - 1, column + kAround_cells);
           ++c) {
        if (map.at(c, r) >= kOccupied_percent) {
          return true;
        }
      }
    }
    return false;
  };
  int returns = 0;
  int known = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    if (!(range_m < ScanParams{}.range_max_m)) {
      continue;
    }
    const double angle_rad = stream.start_angle_rad + static_cast<double>(i) * stream.angle_step_rad;
    ++returns;
    known += has_something(map_T_scan * Point2{range_m * math::cos(angle_rad), range_m * math::sin(angle_rad)}) ? 1 : 0;
  }
  return returns == 0 ? 0.0 : static_cast<double>(known) / returns;
}

void look_up(const Run& run, const OccupancyMap& map, const ScanStream& stream, GapResult& out) {
  constexpr double kWithin_s = 10.0;
  constexpr double kUnset = 2.0;
  const double gap_end_s = out.run.scenario.fault.end_s;
  out.known_share = kUnset;
  out.known_later_share = 1.0;
  for (const SentScan& scan : stream.scans) {
    if (scan.true_s < gap_end_s || scan.true_s > gap_end_s + kWithin_s) {
      continue;
    }
    const double share = known_share(map, stream, scan, run.true_map_T_scan(scan.true_s));
    out.known_share = out.known_share == kUnset ? share : out.known_share;
    out.known_later_share = std::min(out.known_later_share, share);
  }
}

}  // namespace

GapSweep::GapSweep(std::uint64_t campaign_seed) {
  constexpr std::uint64_t kSeeds = 500'000;  // apart from those of other runs
  for (const SweptWorld& world : kSwept) {
    for (int i = 0; i < kTimes; ++i) {
      const double share = static_cast<double>(i) / (kTimes - 1);
      const double start_s = world.first_s + share * (world.last_s - world.first_s);
      const std::uint64_t seed = campaign_seed * 1'000'003U + kSeeds + scenarios_.size();
      for (const double gap_s : kGaps_s) {
        scenarios_.push_back({.index = static_cast<int>(scenarios_.size()),
                              .world = world.name,
                              .laser = "lms",
                              .duration_s = start_s + gap_s + kWatched_s,
                              .fault = {.kind = FaultKind::kSilence, .start_s = start_s, .end_s = start_s + gap_s},
                              .seed = seed});
      }
    }
  }
}

std::vector<GapResult> play_gaps(std::span<const Scenario> scenarios, Trace* trace) {
  std::int64_t begin_ns = thread_cpu_ns();
  Scenario longest = scenarios.front();
  longest.duration_s = std::ranges::max(scenarios, {}, &Scenario::duration_s).duration_s;
  const Drive drive(longest);
  const ScanStream clean = clean_stream(longest, drive);
  Run before(longest, drive);
  before.advance(clean, longest.fault.start_s);
  OccupancyMap map;
  before.chain().filter().filter().write_occupancy(map);
  std::vector<GapResult> results;
  for (const Scenario& scenario : scenarios) {
    Run run = before;
    GapResult out{.run = {.scenario = scenario}, .error_before_m = run.last_error_m()};
    run.change(scenario);
    if (trace != nullptr && &scenario == &scenarios.back()) {
      trace->text = Trace::kHeader;
      run.trace_to(trace);
    }
    ScanStream stream = clean;
    apply_fault(scenario, stream);
    look_up(run, map, stream, out);
    run.advance(stream, scenario.duration_s);
    out.run.verdict = run.verdict();
    out.run.cpu_s = static_cast<double>(thread_cpu_ns() - begin_ns) * 1e-9;
    begin_ns = thread_cpu_ns();
    results.push_back(out);
  }
  return results;
}

}  // namespace odoless::campaign
