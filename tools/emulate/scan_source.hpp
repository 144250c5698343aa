#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// Where an emulated laser's scans come from.
class ScanSource {
 public:
  ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;
  virtual ~ScanSource() = default;

  /// When scan `index` begins, at the mirror's step 0, since the first one; it grows with the index, without end.
  [[nodiscard]] virtual std::int64_t start_ns(std::int64_t index) const = 0;

  /// Measures scan `index`: one range in metres per beam of the model; infinity: no return, 0: nothing can be said.
  virtual void measure(std::int64_t index, std::span<double> ranges_m) = 0;

  /// Where the robot truly was at the first beam of scan `index`, where that is known.
  [[nodiscard]] virtual std::optional<Pose2> world_T_robot(std::int64_t index) const = 0;

  /// When the drive or the log is over: the robot stands still from then on.
  [[nodiscard]] virtual std::int64_t duration_ns() const = 0;
};

}  // namespace odoless
