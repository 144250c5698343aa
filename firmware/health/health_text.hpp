#pragma once

#include <string>
#include <vector>

#include "core/graph/map_correction.hpp"
#include "firmware/records/health.hpp"

namespace odoless {

/// "OK", "DEGRADED" and so on.
[[nodiscard]] const char* name_of(HealthState state);

/// The reasons, a few words each.
[[nodiscard]] std::vector<std::string> reasons_of(std::uint32_t reasons);

/// The same joined by commas; empty if there is none.
[[nodiscard]] std::string reasons_text(std::uint32_t reasons);

/// What the stamps of the scans were like: "631 stamps out of order, 2 gaps of up to 3.0 s; scan period 0.197 s
/// estimated".
[[nodiscard]] std::string times_text(const ScanTimeFindings& times);

/// Whether a correction moves the robot by more than what a pose that is called OK may be off.
[[nodiscard]] bool is_far(const MapCorrection& correction);

/// "the pose is corrected by 0.62 m and 3.1 deg: 3 loop closures, the last one between submaps 12 and 87".
[[nodiscard]] std::string correction_text(const MapCorrection& correction);

/// One line for the log: the state and why.
[[nodiscard]] std::string state_sentence(const HealthReport& report);

}  // namespace odoless
