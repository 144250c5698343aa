#pragma once

#include <vector>

#include "tools/fault_campaign/scenario.hpp"
#include "tools/sim/path.hpp"

namespace odoless::campaign {

/// A robot's true way through its world: along the world's path, until somebody carries it away; from there it wanders.
class Drive {
 public:
  explicit Drive(const Scenario& scenario);

  /// Where the robot is, world frame; `true_s` since the first scan.
  [[nodiscard]] Pose2 at(double true_s) const;
  /// The same in the frame in which the robot started: where the map has it, if all is right. Of a laser that shows a
  /// mirror image of the world, where that has it.
  [[nodiscard]] Pose2 start_T_robot(double true_s) const;
  /// World time, for what moves in it.
  [[nodiscard]] double world_s(double true_s) const { return path_start_s_ + true_s; }

  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] double duration_s() const { return duration_s_; }
  /// Whether it was carried away. Where no place was found for that, the run has no fault.
  [[nodiscard]] bool was_carried() const { return !wandering_.empty(); }

 private:
  void carry_away(const Scenario& scenario);
  [[nodiscard]] bool was_seen(const Pose2& place, const Scenario& scenario) const;

  World world_;
  Path path_;
  double path_start_s_;
  double duration_s_;
  bool mirrored_;
  double carried_s_ = 0.0;
  std::vector<Pose2> wandering_{};  ///< from then on, a step each
};

}  // namespace odoless::campaign
