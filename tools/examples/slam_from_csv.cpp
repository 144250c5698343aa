// Laser odometry, loop closures and the final trajectory in TUM format, of lines of scans: slam_from_csv < SCANS.csv

#include <cmath>
#include <cstdio>
#include <iostream>

#include "core/graph/keyframe_gate.hpp"
#include "core/graph/submap_graph.hpp"
#include "core/odometry/laser_odometry.hpp"
#include "tools/examples/scan_line.hpp"

using namespace odoless;  // NOLINT: an example

int main() {
  const ScanParams scan_params;
  const RobotLimits limits;
  const GraphParams graph_params;
  LaserOdometry odometry({}, limits, {}, scan_params);
  KeyframeGate gate(graph_params);
  SubmapGraph graph(graph_params, limits, scan_params, 1);
  Rng rng(1);

  ScanFrame scan(scan_params);
  std::vector<StampedPose> odom;
  std::vector<BeamCode> codes;
  std::string line;
  for (int number = 1; std::getline(std::cin, line); ++number) {
    if (!ScanLine(line).write_to(scan)) {
      std::cerr << "line " << number << ": no scan, left out\n";
      continue;
    }
    const Motion motion = odometry.process(scan, Deadline{}, rng);
    odom.push_back({scan.stamp_ns(), motion.odom_T_current});
    if (gate.add(motion)) {
      Keyframe keyframe;
      codes.resize(static_cast<std::size_t>(gate.beams(scan)));
      gate.encode(scan, graph.map_T_odom(), keyframe, codes);
      gate.accept();
      static_cast<void>(graph.add(keyframe, codes));
      while (graph.work()) {
      }
    }
  }
  graph.finish();

  for (const StampedPose& pose : graph.corrected(odom)) {
    const Pose2& at = pose.map_T_scan;
    std::printf("%.6f %.4f %.4f 0 0 0 %.6f %.6f\n", 1e-9 * static_cast<double>(pose.stamp_ns), at.x_m, at.y_m,
                std::sin(at.yaw_rad / 2.0), std::cos(at.yaw_rad / 2.0));
  }
}
