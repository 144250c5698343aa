#pragma once

#include <cstdint>
#include <vector>

#include "core/scan/scan_frame.hpp"
#include "tools/fault_campaign/drive.hpp"

namespace odoless::campaign {

/// A scan on its way to the daemon.
struct SentScan {
  double true_s = 0.0;          ///< when it was taken, since the first one
  std::int64_t stamp_ns = 0;    ///< when it is said to be taken
  std::int64_t arrival_ns = 0;  ///< when it arrives
  std::vector<float> ranges_m{};
};

/// True time 0 on the host's clock, which like the daemon's begins in 1970.
inline constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

[[nodiscard]] inline std::int64_t host_ns(double true_s) { return kStart_ns + static_cast<std::int64_t>(true_s * 1e9); }
[[nodiscard]] inline double since_start_s(std::int64_t host_ns) {
  return static_cast<double>(host_ns - kStart_ns) * 1e-9;
}

/// A run's scans in the order of their arrival.
struct ScanStream {
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  std::vector<SentScan> scans{};

  [[nodiscard]] RawScan raw(const SentScan& scan) const {
    return {.stamp_ns = scan.stamp_ns,
            .start_angle_rad = start_angle_rad,
            .angle_step_rad = angle_step_rad,
            .ranges_m = scan.ranges_m};
  }
};

/// What the laser sees on its drive; each scan is stamped and arrives as it is taken.
[[nodiscard]] ScanStream clean_stream(const Scenario& scenario, const Drive& drive);

}  // namespace odoless::campaign
