#pragma once

#include <Eigen/Core>

namespace odoless {

/// What the local map slips by: what no later match takes back of the odometry's error.
///
/// Along a wall without features the pose is known badly, but the wall's old scans mend it as soon as they hold it
/// again. Where a newer scan of the map holds that direction and the older ones do not, as at the wall's end, matches
/// tell the pose against that scan alone: what its own place was off by stays, however well they are held [method 4].
///
/// Covariances are over (x_m, y_m), all in the axes of one frame, odom. Thread: owned by one thread. Real time: no
/// allocation, constant time.
class MapSlip {
 public:
  /// The map begins anew with one scan, wherever that is.
  void reset() { *this = MapSlip{}; }
  /// A scan was matched.
  /// @param held   Covariance of the match alone.
  /// @param error  Of the scan's pose then.
  /// @return       What the map that it was matched with has slipped by: once for each map.
  [[nodiscard]] Eigen::Matrix2d match(const Eigen::Matrix2d& held, const Eigen::Matrix2d& error);
  /// A map with that scan as its newest one is begun.
  void begin_map() { next_ = newest_; }
  /// The next scans are matched with it.
  void take_map() { map_ = next_; }

 private:
  struct Key {
    Eigen::Matrix2d held = Eigen::Matrix2d::Zero();   ///< by the map before
    Eigen::Matrix2d error = Eigen::Matrix2d::Zero();  ///< the largest since a scan was held well; 0: accounted for
  };

  Key newest_, next_, map_;
};

}  // namespace odoless
