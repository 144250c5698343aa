#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tools/sim/simulated_lrf.hpp"

namespace odoless {

/// Whether the laser's beams are those that every reader takes a FLASER line to have: 181 or 361 from -90 to 90 deg,
/// with a range that SICK's code for no return doesn't cut.
[[nodiscard]] bool fits_flaser(const SimulatedLrf& lrf);

/// One line of a CARMEN log, with its end: a FLASER message where that fits, else ROBOTLASER1, which tells the angles
/// and the maximum range. Ranges in whole millimetres; every pose and velocity is 0, for there is no odometry.
///
/// @param ranges_m  From the right to the left; infinity for no return, which is written as SICK's 81.91 m, or as the
///                  maximum range where that is more.
[[nodiscard]] std::string carmen_line(const SimulatedLrf& lrf, std::span<const double> ranges_m, std::int64_t stamp_ns);

}  // namespace odoless
