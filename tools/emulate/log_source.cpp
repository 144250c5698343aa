#include "tools/emulate/log_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace odoless {
namespace {

constexpr double kNoReturn = std::numeric_limits<double>::infinity();

double range_at_m(const LogScan& scan, double angle_rad) {
  const double beam = std::round((angle_rad - scan.start_angle_rad) / scan.angle_step_rad);
  if (beam < 0.0 || beam >= static_cast<double>(scan.ranges_m.size())) {
    return kNoReturn;
  }
  const float range_m = scan.ranges_m[static_cast<std::size_t>(beam)];
  if (std::isnan(range_m) || range_m <= 0.0F) {
    return 0.0;
  }
  return range_m >= scan.no_return_m ? kNoReturn : static_cast<double>(range_m);
}

}  // namespace

LogSource::LogSource(std::int64_t period_ns, ScanLog log, double speed_ratio)
    : period_ns_(period_ns), log_(std::move(log)) {
  std::int64_t last_ns = -1;
  for (const LogScan& scan : log_.scans) {
    const double since_first_ns = static_cast<double>(scan.stamp_ns - log_.scans[0].stamp_ns);
    // A device's scans never come in pairs, whatever was recorded.
    last_ns = std::max<std::int64_t>(std::llround(since_first_ns / speed_ratio), last_ns + 1'000'000);
    starts_ns_.push_back(starts_ns_.empty() ? 0 : last_ns);
  }
}

std::int64_t LogSource::start_ns(std::int64_t index) const {
  const std::int64_t last = static_cast<std::int64_t>(starts_ns_.size()) - 1;
  return index <= last ? starts_ns_[static_cast<std::size_t>(index)] : starts_ns_.back() + (index - last) * period_ns_;
}

void LogSource::measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m) {
  const LogScan& scan = log_.scans[std::min(static_cast<std::size_t>(index), log_.scans.size() - 1)];
  for (std::size_t i = 0; i < beams.size(); ++i) {
    ranges_m[i] = range_at_m(scan, beams[i].angle_rad);
  }
}

}  // namespace odoless
