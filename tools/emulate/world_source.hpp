#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "core/base/rng.hpp"
#include "core/cloud/tilt_mount.hpp"
#include "tools/emulate/emulated_scans.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world.hpp"

namespace odoless {

/// A drive through a simulated world.
struct WorldDrive {
  World world;
  double start_delay_s = 0.0;  ///< how long the robot stands at the start of its path
  double speed_ratio = 1.0;    ///< how many times faster than its path says it drives
  double noise_sd_m = 0.01;
  bool distortion = false;  ///< whether each beam is cast at its own time, and not all at the time of the first
  std::uint64_t seed = 1;
};

/// How a servo tilts the laser of a drive.
struct LaserTilt {
  TiltMount mount;
  std::function<double(std::int64_t time_ns)> tilt_rad;  ///< at a time of the source
};

/// The scans of a laser that is driven through a world. The same drive gives the same ranges, scan by scan.
class WorldSource final : public EmulatedScans {
 public:
  /// @param period_ns  From scan to scan.
  WorldSource(std::int64_t period_ns, WorldDrive drive);

  /// From now on the laser is tilted so, and looks into the world's space.
  void tilt(LaserTilt tilt) { tilt_ = std::move(tilt); }

  [[nodiscard]] std::int64_t start_ns(std::int64_t index) const override { return index * period_ns_; }
  void measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m) override;
  [[nodiscard]] std::optional<Pose2> world_T_robot(std::int64_t time_ns) const override;
  [[nodiscard]] std::int64_t duration_ns() const override;

 private:
  [[nodiscard]] Pose2 pose_at(std::int64_t time_ns) const;
  [[nodiscard]] double true_range_m(std::int64_t time_ns, const Pose2& world_T_robot, double angle_rad) const;

  std::int64_t period_ns_;
  WorldDrive drive_;
  Path path_;
  std::optional<LaserTilt> tilt_;
};

}  // namespace odoless
