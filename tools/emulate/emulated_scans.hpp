#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// One beam of an emulated laser.
struct EmulatedBeam {
  double angle_rad = 0.0;    ///< 0 is the front, positive to the left
  std::int64_t time_ns = 0;  ///< when it is measured, since its scan began
};

/// Where an emulated laser's scans come from.
class EmulatedScans {
 public:
  EmulatedScans() = default;
  EmulatedScans(const EmulatedScans&) = delete;
  EmulatedScans& operator=(const EmulatedScans&) = delete;
  virtual ~EmulatedScans() = default;

  /// When scan `index` begins since the first one; it grows with the index, without end.
  [[nodiscard]] virtual std::int64_t start_ns(std::int64_t index) const = 0;

  /// Measures scan `index`: one range in metres per beam; infinity: no return, 0: nothing can be said.
  virtual void measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m) = 0;

  /// Where the robot truly was at that time of the source, where that is known.
  [[nodiscard]] virtual std::optional<Pose2> world_T_robot(std::int64_t time_ns) const = 0;

  /// When the drive or the log is over: the robot stands still from then on.
  [[nodiscard]] virtual std::int64_t duration_ns() const = 0;
};

}  // namespace odoless
