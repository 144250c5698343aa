#pragma once

#include <span>
#include <vector>

#include "core/base/stamped_history.hpp"
#include "tools/cloud/cloud_run.hpp"

namespace odoless {

/// The tilt angle of each beam of a log's scans.
class BeamTilts {
 public:
  BeamTilts(const TiltLog& log, const ServoParams& servo, double gap_max_s);

  /// One per beam, NaN where it is not known; valid until the next call.
  [[nodiscard]] std::span<const double> of(const LogScan& scan);

 private:
  StampedHistory<double, OnTheLine> angles_;  ///< by the scans' clock
  std::vector<double> tilts_rad_;
};

}  // namespace odoless
