#pragma once

#include "tools/emulate/scan_source.hpp"
#include "tools/emulate/scip_model.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// The scans of a recorded log, each at its recorded stamp; every beam of the model takes the nearest recorded one, and
/// has no return where there is none within a step. After the last one, it is repeated at the model's rate.
class LogSource final : public ScanSource {
 public:
  /// @param speed_ratio  How many times faster than recorded.
  LogSource(const ScipModel& model, ScanLog log, double speed_ratio);

  [[nodiscard]] std::int64_t start_ns(std::int64_t index) const override;
  void measure(std::int64_t index, std::span<double> ranges_m) override;
  [[nodiscard]] std::optional<Pose2> world_T_robot(std::int64_t) const override { return {}; }
  [[nodiscard]] std::int64_t duration_ns() const override { return starts_ns_.back(); }

 private:
  ScipModel model_;
  ScanLog log_;
  std::vector<std::int64_t> starts_ns_;
};

}  // namespace odoless
