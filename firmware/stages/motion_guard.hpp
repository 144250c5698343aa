#pragma once

#include <cstdint>

#include "core/motion/motion.hpp"
#include "core/motion/robot_limits.hpp"

namespace odoless {

/// What becomes of a motion that came from outside.
enum class MotionVerdict {
  kFollows,    ///< the last one, perhaps after some that were lost
  kContinues,  ///< the last one, by another clock: its stamps tell nothing of the time between them
  kBegins,     ///< it is the first one, or of odometry that began anew
  kOld,        ///< it came twice, or after its successor
  kRefused,    ///< no motion of this robot, or none of now
};

/// Says which motions of a matcher elsewhere are taken. Anybody on the network can send one: each is held to what the
/// robot can do, and to when those before it came.
///
/// Refused and counted are: stamps that are far from those of the last motion, for the time since it came (a log may be
/// played at ten times its pace); steps, and ways since the last motion by the odometry's pose, that are far beyond the
/// robot's limits; covariances that are none, or wider than the robot's limits can explain. Ten in a row that follow
/// each other, and not the last one taken, are those of a sender whose clock was set or that began anew: they are taken
/// from then on. A robot that was carried off is believed as soon as it could have gone so far.
///
/// Pure: time comes in as stamps. Thread: sensor thread. Real time: no allocation.
class MotionGuard {
 public:
  explicit MotionGuard(const RobotLimits& limits) : limits_(limits) {}

  [[nodiscard]] MotionVerdict judge(const Motion& motion, std::int64_t now_ns);
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// From the arrival of the motion before the last one that was taken to that one's own.
  [[nodiscard]] std::int64_t arrived_after_ns() const { return arrived_after_ns_; }

  static constexpr int kAnewMotions = 10;
  static constexpr double kPaceMax = 10.0;                   ///< recorded seconds per second
  static constexpr std::int64_t kAhead_ns = 5'000'000'000;   ///< of where that pace leads
  static constexpr std::int64_t kBehind_ns = 5'000'000'000;  ///< what is older has not merely been late

 private:
  /// A motion, and when it came.
  struct Place {
    std::int64_t to_stamp_ns = 0;
    std::int64_t arrival_ns = 0;
    Pose2 odom_T_current{};
  };

  [[nodiscard]] bool is_possible(const Motion& motion) const;
  [[nodiscard]] bool is_within_reach(const Pose2& way, double time_s, double slack_m) const;
  [[nodiscard]] bool follows(const Place& last, const Motion& motion, std::int64_t now_ns) const;
  [[nodiscard]] bool begins_anew(const Motion& motion, std::int64_t now_ns);
  MotionVerdict accept(const Motion& motion, std::int64_t now_ns, MotionVerdict verdict);

  RobotLimits limits_;
  bool has_last_ = false;
  Place last_;
  Place other_;  ///< the last one that did not follow
  int others_in_a_row_ = 0;
  std::int64_t arrived_after_ns_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace odoless
