#include "tools/fault_campaign/tally.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace odoless::campaign {

void Tally::add(const RunResult& run) {
  const Verdict& verdict = run.verdict;
  ++runs;
  silent_failures += verdict.failed_silently() ? 1 : 0;
  silent_max_s = std::max(silent_max_s, verdict.silent_s);
  said_after_s.insert(said_after_s.end(), verdict.said_after_s.begin(), verdict.said_after_s.end());
  if (std::isfinite(verdict.recovered_after_s)) {
    recovered_after_s.push_back(verdict.recovered_after_s);
  }
  final_errors_m.push_back(verdict.final_error_m);
  for (std::size_t i = 0; i < kStates; ++i) {
    scans[i] += verdict.scans[i];
    right_scans[i] += verdict.right_scans[i];
  }
  calibration.add(verdict.calibration);
  cpu_s += run.cpu_s;
}

double Tally::share_of(HealthState state) const {
  const std::int64_t all = std::accumulate(scans.begin(), scans.end(), std::int64_t{0});
  return all == 0 ? 0.0 : static_cast<double>(scans.at(static_cast<std::size_t>(state))) / static_cast<double>(all);
}

double Tally::share_right(HealthState state) const {
  const auto i = static_cast<std::size_t>(state);
  return scans.at(i) == 0 ? 1.0 : static_cast<double>(right_scans.at(i)) / static_cast<double>(scans.at(i));
}

Tally tally_of(std::span<const RunResult> runs) {
  Tally tally;
  for (const RunResult& run : runs) {
    tally.add(run);
  }
  return tally;
}

Tally tally_of(std::span<const RunResult> runs, FaultKind kind) {
  Tally tally;
  for (const RunResult& run : runs) {
    if (run.scenario.fault.kind == kind) {
      tally.add(run);
    }
  }
  return tally;
}

}  // namespace odoless::campaign
