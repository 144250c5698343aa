#pragma once

#include "tools/emulate/emulated_scans.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// The scans of a recorded log, each at its recorded stamp; every beam takes the nearest recorded one, and
/// has no return where there is none within a step. After the last one, it is repeated at the laser's own rate.
class LogSource final : public EmulatedScans {
 public:
  /// @param period_ns    Of the laser, from scan to scan.
  /// @param speed_ratio  How many times faster than recorded.
  LogSource(std::int64_t period_ns, ScanLog log, double speed_ratio);

  [[nodiscard]] std::int64_t start_ns(std::int64_t index) const override;
  void measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m) override;
  [[nodiscard]] std::optional<Pose2> world_T_robot(std::int64_t) const override { return {}; }
  [[nodiscard]] std::int64_t duration_ns() const override { return starts_ns_.back(); }

 private:
  std::int64_t period_ns_;
  ScanLog log_;
  std::vector<std::int64_t> starts_ns_;
};

}  // namespace odoless
