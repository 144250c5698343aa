#pragma once

#include "tools/fault_campaign/scan_stream.hpp"

namespace odoless::campaign {

/// Lets the scenario's fault happen to a clean stream; scans are then in the order of their arrival.
void apply_fault(const Scenario& scenario, ScanStream& stream);

/// When the daemon does nothing at all, not even say how it is.
struct Standstill {
  double from_s = 0.0;
  double until_s = 0.0;
};
[[nodiscard]] Standstill standstill_of(const Scenario& scenario);

/// Faults of the scans' times: which are missing, when they arrive, what their stamps say. Parts of `apply_fault`.
void apply_to_times(const Scenario& scenario, ScanStream& stream);
/// Faults of what scans show.
void apply_to_ranges(const Scenario& scenario, ScanStream& stream);

}  // namespace odoless::campaign
