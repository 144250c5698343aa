#include "tools/log/log_info.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

#include "tools/command/error.hpp"
#include "tools/log/log_times.hpp"

namespace odoless {
namespace {

constexpr double kSecondsPerNanosecond = 1e-9;
constexpr std::size_t kBeamsMax = 16384;  // the largest ScanParams::beams_max

void add_geometry(const LogScan& scan, LogInfo& info) {
  const std::size_t beams = scan.ranges_m.size();
  const double end_rad = scan.start_angle_rad + static_cast<double>(beams - 1) * scan.angle_step_rad;
  info.beams_min = std::min(info.beams_min, beams);
  info.beams_max = std::max(info.beams_max, beams);
  info.angle_min_rad = std::min({info.angle_min_rad, scan.start_angle_rad, end_rad});
  info.angle_max_rad = std::max({info.angle_max_rad, scan.start_angle_rad, end_rad});
  info.angle_step_min_rad = std::min(info.angle_step_min_rad, scan.angle_step_rad);
  info.angle_step_max_rad = std::max(info.angle_step_max_rad, scan.angle_step_rad);
}

void add_times(const ScanLog& log, LogInfo& info) {
  const auto older = [](const LogScan& a, const LogScan& b) { return a.stamp_ns < b.stamp_ns; };
  const auto [oldest, newest] = std::minmax_element(log.scans.begin(), log.scans.end(), older);
  // Each by itself: the difference of two hostile stamps need not fit.
  info.duration_s = static_cast<double>(newest->stamp_ns) * kSecondsPerNanosecond -
                    static_cast<double>(oldest->stamp_ns) * kSecondsPerNanosecond;
  info.rate_hz = info.duration_s > 0.0 ? static_cast<double>(log.scans.size() - 1) / info.duration_s : 0.0;
  info.times = times_of(log, 1).findings;
}

/// Counts of beams by what they say, and the ranges of the returns.
struct Beams {
  std::array<std::size_t, 3> counts{};
  std::vector<double> ranges_m;

  void add(const ScanFrame& frame) {
    for (int beam = 0; beam < frame.size(); ++beam) {
      ++counts[static_cast<std::size_t>(frame.state(beam))];
      if (frame.is_return(beam)) {
        ranges_m.push_back(frame.range_m(beam));
      }
    }
  }

  [[nodiscard]] double share(BeamState state) const {
    const std::size_t all = counts[0] + counts[1] + counts[2];
    return static_cast<double>(counts[static_cast<std::size_t>(state)]) / static_cast<double>(all);
  }
};

void add_beams(const ScanLog& log, const std::string& name, LogInfo& info) {
  ScanFrame frame(ScanParams{.beams_max = static_cast<int>(std::clamp<std::size_t>(info.beams_max, 8, kBeamsMax))});
  Beams beams;
  for (const LogScan& scan : log.scans) {
    if (frame.assign(scan.raw()) != Errc::kOk) {
      throw DataError(name, 0, fmt::format("a scan has {} beams", scan.ranges_m.size()),
                      fmt::format("at most {}", kBeamsMax));
    }
    beams.add(frame);
  }
  info.return_share = beams.share(BeamState::kReturn);
  info.no_return_share = beams.share(BeamState::kNoReturn);
  info.invalid_share = beams.share(BeamState::kInvalid);
  if (!beams.ranges_m.empty()) {
    info.range_min_m = *std::min_element(beams.ranges_m.begin(), beams.ranges_m.end());
    info.range_m = summarise(std::move(beams.ranges_m));
  }
}

}  // namespace

LogInfo summarise(const ScanLog& log, const std::string& name) {
  const LogScan& first = log.scans.front();
  LogInfo info;
  info.format = log.format;
  info.scans = log.scans.size();
  info.has_stamps = log.has_stamps;
  info.beams_min = info.beams_max = first.ranges_m.size();
  info.angle_min_rad = info.angle_max_rad = first.start_angle_rad;
  info.angle_step_min_rad = info.angle_step_max_rad = first.angle_step_rad;
  for (const LogScan& scan : log.scans) {
    add_geometry(scan, info);
  }
  info.sweep_s =
      static_cast<double>(std::abs(first.beam_period_ns) * static_cast<std::int64_t>(first.ranges_m.size())) *
      kSecondsPerNanosecond;
  add_times(log, info);
  add_beams(log, name, info);
  return info;
}

}  // namespace odoless
