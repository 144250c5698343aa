// Whatever a tilt log holds, reading it ends with scans and angles that can be put together, or a DataError.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/check.hpp"
#include "tools/cloud/beam_tilts.hpp"
#include "tools/command/error.hpp"
#include "tools/log/tilt_log.hpp"

namespace odoless {
namespace {

template <class Stamped>
bool stamps_grow(const std::vector<Stamped>& all) {
  return std::adjacent_find(all.begin(), all.end(),
                            [](const auto& a, const auto& b) { return a.stamp_ns >= b.stamp_ns; }) == all.end();
}

bool is_whole(const LogScan& scan) {
  return !scan.ranges_m.empty() && std::isfinite(scan.start_angle_rad) && std::isfinite(scan.angle_step_rad) &&
         scan.angle_step_rad != 0.0 && scan.beam_period_ns >= 0;
}

void check(const TiltLog& log) {
  ODOLESS_CHECK(log.scans.size() >= 2 && stamps_grow(log.scans));
  ODOLESS_CHECK(log.angles.size() >= 2 && stamps_grow(log.angles));
  ODOLESS_CHECK(std::all_of(log.scans.begin(), log.scans.end(), is_whole));
  ODOLESS_CHECK(std::all_of(log.angles.begin(), log.angles.end(),
                            [](const ServoAngle& angle) { return std::isfinite(angle.angle_rad); }));
  constexpr double kGapMaxS = 0.5;
  BeamTilts tilts(log, {.clock_ahead_ns = log.row_offset_ns}, kGapMaxS);
  for (const LogScan& scan : log.scans) {
    ODOLESS_CHECK(tilts.of(scan).size() == scan.ranges_m.size());
  }
}

}  // namespace
}  // namespace odoless

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    odoless::LineReader lines(odoless::view_bytes({reinterpret_cast<const char*>(data), size}, "fuzz"), "fuzz");
    odoless::check(odoless::read_tilt_log(lines));
  } catch (const odoless::DataError&) {
  }
  return 0;
}
