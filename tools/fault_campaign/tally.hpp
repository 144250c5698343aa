#pragma once

#include <span>
#include <vector>

#include "tools/fault_campaign/run.hpp"

namespace odoless::campaign {

/// The figures of many runs.
struct Tally {
  int runs = 0;
  int silent_failures = 0;
  double silent_max_s = 0.0;
  std::vector<double> said_after_s{};
  std::vector<double> recovered_after_s{};  ///< of the runs that did
  std::vector<double> final_errors_m{};
  std::array<std::int64_t, kStates> scans{};
  std::array<std::int64_t, kStates> right_scans{};
  Calibration calibration{};
  double cpu_s = 0.0;

  void add(const RunResult& run);
  [[nodiscard]] double share_of(HealthState state) const;
  /// How often poses that were said to be in that state were right; 1 where there are none.
  [[nodiscard]] double share_right(HealthState state) const;
};

/// Of all runs, and of those of one kind.
[[nodiscard]] Tally tally_of(std::span<const RunResult> runs);
[[nodiscard]] Tally tally_of(std::span<const RunResult> runs, FaultKind kind);

}  // namespace odoless::campaign
