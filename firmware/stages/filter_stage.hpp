#pragma once

#include <cstdint>
#include <span>

#include "config/robot_params.hpp"
#include "core/odometry/laser_odometry.hpp"
#include "core/slam/recovery.hpp"
#include "core/slam/slam.hpp"

namespace odoless {

/// What the filter makes of one scan. A scan between two updates hangs on the last one.
struct FilterStep {
  Pose2 map_T_scan{};                ///< as known now: the mean of the particles, which is steadier than the best
  Pose2 map_T_odom{};                ///< corrects the drift of the odometry; jumps where a loop is closed
  std::int64_t update_stamp_ns = 0;  ///< of the last update
  Pose2 update_T_scan{};             ///< motion since then
  bool updated = false;
  UpdateReport report{};
  Tracking tracking = Tracking::kSure;
  double probability = 1.0;  ///< that map_T_scan is right within 0.5 m and 5 deg
  bool found = false;        ///< a lost robot, with this scan
  /// How often, until now, the robot was put elsewhere than the motions lead: it was found, somebody said where it is,
  /// or other particles survived after a step that may have been wrong.
  int placements = 0;
  int unconfirmed = 0;     ///< Recovery's: beside a pose graph it is for that to say how probable the pose is then
  double unknown_s = 0.0;  ///< Recovery's, with this scan: the motion since then is not credible, whatever it says
  double fit = 1.0;        ///< ScanFit of the scan; 1 before the first update
  /// Beside a pose graph: what the map may have drifted there (FilterInWorld::drift), and that OK ends by that alone.
  Eigen::Matrix3d drift = Eigen::Matrix3d::Zero();
  bool has_drifted = false;
};

/// Motion in, poses and a map out: the filter thread's work. Composes motions and updates the filter when the robot
/// has moved far enough. A robot that is lost maps nothing until it is found.
/// Motions without a scan and the next one with a scan give what their composition with that scan gives.
/// The map begins at the odometry's origin.
///
/// Thread: filter thread, or the one thread of a replay. Real time: no allocation after construction.
class FilterStage {
 public:
  FilterStage(const RobotParams& params, std::uint64_t seed);

  /// @param deadline  For a live filter that must keep its time (Lslam::update).
  [[nodiscard]] FilterStep process(const ScanFrame& scan, const Motion& motion, const Deadline& deadline = {});
  /// A motion whose scan was lost: the pose goes on, and the next scan may update the filter.
  [[nodiscard]] FilterStep process(const Motion& motion);

  /// Forgets poses and map; the next scan is taken from here.
  void reset(const Pose2& map_T_scan);
  /// Keeps the map, and takes the robot to be here.
  void set_pose(const Pose2& map_T_scan);
  /// While paused, poses go on and nothing is mapped.
  void pause(bool paused) { paused_ = paused; }
  [[nodiscard]] bool paused() const { return paused_; }

  [[nodiscard]] const GridGeometry& geometry() const { return filter_.geometry(); }
  /// A square of the best map: Slam::write_square.
  [[nodiscard]] bool write_tile(GridCell corner, int side_cells, std::span<std::uint8_t> percent) {
    return filter_.write_square(corner, side_cells, percent);
  }

  /// For a live filter that must keep its time; a replay runs with all (Slam::set_particles).
  void set_particles(int wanted) { filter_.set_particles(wanted); }

  /// On the robot.
  [[nodiscard]] const LaserPlace& laser() const { return laser_; }
  [[nodiscard]] Slam& filter() { return filter_; }
  [[nodiscard]] Tracking tracking() const { return recovery_.state(); }

 private:
  [[nodiscard]] bool gate_is_open() const;
  void begin();
  void compose(const Motion& motion);
  /// The filter's particles have been put where the scan at this stamp was.
  void restart(std::int64_t stamp_ns);
  void update(const ScanFrame& scan, const Deadline& deadline, FilterStep& out);
  /// What the filter thinks of its pose, now that it sees this scan.
  [[nodiscard]] Advice diagnose(const ScanFrame& scan);
  [[nodiscard]] FilterStep placed(FilterStep out, const Motion& motion) const;

  GateParams gate_;
  LaserPlace laser_;
  Slam filter_;
  Recovery recovery_;
  Motion since_update_{};  ///< to the last motion's end
  Motion since_scan_{};
  std::int64_t update_stamp_ns_ = 0;
  int placements_ = 0;
  bool is_in_graph_;    ///< beside a pose graph
  bool begun_ = false;  ///< the first scan, or a command, has said where the map begins
  bool started_ = false;
  bool paused_ = false;
};

}  // namespace odoless
