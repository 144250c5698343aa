#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "firmware/stages/filter_stage.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world.hpp"

namespace odoless::test {

/// What became of a robot that was carried away.
struct Kidnapping {
  bool happened = false;                                           ///< there was a place to carry it to
  double lost_after_s = std::numeric_limits<double>::infinity();   ///< the robot said so
  double found_after_s = std::numeric_limits<double>::infinity();  ///< right and not lost, and so until the end
  double wrong_sure_s = 0.0;     ///< longest time of being sure and wrong by more than 0.5 m or 5 deg at a stretch
  double wrong_claimed_s = 0.0;  ///< the same of not being lost, sure or not, once it was found again
  double slice_us_max = 0.0;     ///< CPU time of a scan in the filter while lost
  std::int64_t lost_scans = 0;
  std::int64_t heap_calls = 0;  ///< of the filter, from the kidnapping on
};

/// A laser of 5 Hz on a robot that maps a world along its path, is carried away, and wanders on from there.
///
/// The robot is carried 3 m, and turned by 90 deg, in no time, to a place that its map knows to be free. It then drives
/// on wherever there is room.
class KidnappedRobot {
 public:
  KidnappedRobot(const World& world, const RobotParams& params, std::uint64_t seed);

  /// Goes on along the world's path, and maps, until this share of it is done.
  void drive_until(double share);
  /// Carries the robot away, and watches it for so long. A copy of the robot, which can be carried elsewhere, goes on
  /// by the chance of its own seed.
  [[nodiscard]] Kidnapping carry_away(std::uint64_t seed, double watched_s);

  static constexpr double kPeriod_s = 0.2;

 private:
  [[nodiscard]] FilterStep scan();
  /// 3 m and a quarter turn from here, free and known.
  [[nodiscard]] bool choose_place();
  [[nodiscard]] bool is_wrong(const Pose2& map_T_scan) const;

  World world_;
  Path path_;
  MatcherStage matcher_;
  FilterStage filter_;
  ScanFrame frame_;
  Rng chance_;
  Pose2 world_T_map_;  ///< as the map has it: its first metres may be off of the rest
  Pose2 map_T_scan_;
  std::vector<float> ranges_m_;
  Pose2 world_T_robot_;
  std::int64_t scans_ = 0;
  double slice_us_ = 0.0;
  std::int64_t heap_calls_ = 0;
};

}  // namespace odoless::test
