#pragma once

#include "core/graph/graph_params.hpp"
#include "core/match/matcher_params.hpp"
#include "core/motion/robot_limits.hpp"
#include "core/odometry/laser_odometry.hpp"
#include "core/scan/laser_mount_params.hpp"
#include "core/scan/scan_frame.hpp"
#include "core/slam/recovery_params.hpp"
#include "core/slam/slam_params.hpp"

namespace odoless {

/// When the filter takes a scan: the robot has moved, by what the matcher says.
struct GateParams {
  double distance_m = 0.2;
  double rotation_rad = 0.17453292519943295;
  bool widen_by_match = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("distance_m", self.distance_m, Range{0.0, 10.0}, "Travel after which the filter is updated.");
    visit.value("rotation_rad", self.rotation_rad, Range{0.0, 3.1416}, "Rotation after which the filter is updated.");
    visit.flag("widen_by_match", self.widen_by_match, "Whether the covariance of a match widens the motion model.");
  }
};

/// All that a configuration file can say.
struct RobotParams {
  RobotLimits limits;
  LaserMountParams mount;
  ScanParams scan;
  MatcherParams matcher;
  LaserOdometryParams odometry;
  GateParams gate;
  SlamParams slam;
  RecoveryParams recovery;
  GraphParams graph;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("robot", self.limits, "How the robot, or whoever carries the laser, can move.");
    visit.group("lrf.mount", self.mount,
                "How the laser is mounted on the robot, which beams are used, and when they were measured.");
    visit.group("scan", self.scan, "What of a scan is used.");
    visit.group("matcher", self.matcher, "Scan matching: NDT and Differential Evolution.");
    visit.group("odometry", self.odometry, "Tracking from scan to scan against a local map.");
    visit.group("gate", self.gate, "When the filter is updated.");
    visit.group("slam", self.slam, "DP-SLAM.");
    visit.group("recovery", self.recovery, "Self-diagnosis, and the search for a robot that is lost.");
    visit.group("graph", self.graph, "Pose graph of submaps: closes loops of any size.");
  }
};

}  // namespace odoless
