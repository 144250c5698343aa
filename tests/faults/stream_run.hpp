#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "config/robot_params.hpp"
#include "firmware/records/health.hpp"
#include "tools/fault_campaign/scan_stream.hpp"
#include "tools/sim/world.hpp"

namespace odoless::test {

/// A drive along a world's path, and what becomes of the scans on their way to the daemon.
struct FaultyDrive {
  World world{};
  SimulatedLrfParams laser{};
  double duration_s = 16.0;
  double from_s = 6.0;   ///< when the fault begins
  double until_s = 9.0;  ///< and ends
  std::function<void(campaign::ScanStream&)> spoil{};
  std::uint64_t seed = 1;
};

/// What the daemon said while it was so. Times that never came are infinite.
struct FaultyRun {
  static constexpr double kNever_s = std::numeric_limits<double>::infinity();

  double flag_s = kNever_s;     ///< from the fault's first scan that is missing or wrong to the first state but OK
  double recover_s = kNever_s;  ///< from the fault's end to OK, from then on for a second, with the right pose
  double rms_m = 0.0;           ///< of the published poses since the fault began
  double rms_yaw_rad = 0.0;
  Pose2 final_off{};  ///< true pose to published pose, of the last scan
  double final_error_m = 0.0;
  double final_error_rad = 0.0;
  double largest_step_m = 0.0;  ///< between two poses that were published while it lasted
  double wrong_and_ok_s = 0.0;  ///< longest time at a stretch
  double not_ok_share = 0.0;    ///< of the fault's time
  std::uint32_t reasons = 0;    ///< all that were given while it lasted
  int maps_made = 0;            ///< updates of the map while it lasted
  bool is_finite = true;        ///< every pose that was published
  HealthReport last{};
};

/// A room that the robot drives through at 0.5 m/s, and a laser of 10 Hz with 271 beams over 270 deg and 30 m.
[[nodiscard]] FaultyDrive drive_of(const std::string& world);
[[nodiscard]] double period_s(const FaultyDrive& drive);

/// Plays it through the daemon's own stages and health monitor, in simulated time.
[[nodiscard]] FaultyRun play(const FaultyDrive& drive);

/// Calls it with each scan that is taken while the fault lasts.
void for_each_faulty(const FaultyDrive& drive, campaign::ScanStream& stream,
                     const std::function<void(campaign::SentScan&)>& change);

}  // namespace odoless::test
