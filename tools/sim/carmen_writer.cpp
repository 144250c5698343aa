#include "tools/sim/carmen_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace odoless {
namespace {

constexpr double kSickNoReturnM = 81.91;
constexpr double kSickRangeMaxM = 81.8;

void append_ranges(std::string& line, std::span<const double> ranges_m, double no_return_m) {
  for (const double range_m : ranges_m) {
    fmt::format_to(std::back_inserter(line), " {:.3f}", std::isfinite(range_m) ? range_m : no_return_m);
  }
}

}  // namespace

bool fits_flaser(const SimulatedLrf& lrf) {
  const SimulatedLrfParams& params = lrf.params();
  return std::abs(params.field_of_view_rad - std::numbers::pi) < 1e-9 && (params.beams == 181 || params.beams == 361) &&
         params.range_max_m <= kSickRangeMaxM;
}

std::string carmen_line(const SimulatedLrf& lrf, std::span<const double> ranges_m, std::int64_t stamp_ns) {
  const SimulatedLrfParams& params = lrf.params();
  const double no_return_m = std::max(kSickNoReturnM, params.range_max_m);
  const std::string stamp_s = fmt::format("{:.6f}", static_cast<double>(stamp_ns) * 1e-9);
  if (fits_flaser(lrf)) {
    std::string line = fmt::format("FLASER {}", ranges_m.size());
    append_ranges(line, ranges_m, no_return_m);
    return line + fmt::format(" 0 0 0 0 0 0 {0} simulation {0}\n", stamp_s);
  }
  const double span_rad = lrf.angle_step_rad() * static_cast<double>(ranges_m.size() - 1);
  constexpr int kLaserType = 0;
  constexpr double kAccuracyM = 0.001;
  std::string line =
      fmt::format("ROBOTLASER1 {} {:.9f} {:.9f} {:.9f} {:.3f} {:.3f} 0 {}", kLaserType, lrf.start_angle_rad(), span_rad,
                  lrf.angle_step_rad(), params.range_max_m, kAccuracyM, ranges_m.size());
  append_ranges(line, ranges_m, no_return_m);
  return line + fmt::format(" 0 0 0 0 0 0 0 0 0 0 0 0 {0} simulation {0}\n", stamp_s);
}

}  // namespace odoless
