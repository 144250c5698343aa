// The Python module `odoless`: arrays of scans in, arrays of poses out. README.md says how.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/graph/keyframe_gate.hpp"
#include "core/graph/submap_graph.hpp"
#include "core/odometry/laser_odometry.hpp"

namespace py = pybind11;

namespace odoless {
namespace {

using Ranges = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Poses = py::array_t<double>;

/// What all scans have in common.
struct Laser {
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  double range_max_m = 30.0;

  [[nodiscard]] ScanParams params(py::ssize_t beams) const {
    ScanParams out;
    out.beams_max = static_cast<int>(std::max<py::ssize_t>(beams, 8));
    out.range_max_m = range_max_m;
    if (!parameters_in_range(out)) {
      throw py::value_error("range_max_m must be 0.5 to 200, and a scan have at most 16384 beams");
    }
    return out;
  }
};

void assign(ScanFrame& frame, const Laser& laser, double stamp_s, std::span<const float> ranges_m) {
  if (!std::isfinite(stamp_s) || std::abs(stamp_s) > 9e9) {
    throw py::value_error("a stamp must be a number of seconds within +-9e9");
  }
  const Errc error = frame.assign({.stamp_ns = std::llround(1e9 * stamp_s),
                                   .start_angle_rad = laser.start_angle_rad,
                                   .angle_step_rad = laser.angle_step_rad,
                                   .ranges_m = ranges_m});
  if (error != Errc::kOk) {
    throw py::value_error(std::string("scan refused: ") + describe(error));
  }
}

Poses to_array(const std::vector<StampedPose>& poses) {
  Poses out({static_cast<py::ssize_t>(poses.size()), py::ssize_t{3}});
  auto rows = out.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const Pose2& pose = poses[static_cast<std::size_t>(i)].map_T_scan;
    rows(i, 0) = pose.x_m;
    rows(i, 1) = pose.y_m;
    rows(i, 2) = pose.yaw_rad;
  }
  return out;
}

/// Laser odometry and the pose graph over all scans, without the interpreter's lock.
class Replay {
 public:
  Replay(const ScanParams& scan, std::uint64_t seed)
      : odometry_({}, limits_, {}, scan), gate_({}), graph_({}, limits_, scan, seed), rng_(seed) {}

  void add(const ScanFrame& scan) {
    const Motion motion = odometry_.process(scan, Deadline{}, rng_);
    online_.push_back({scan.stamp_ns(), graph_.map_T_odom() * motion.odom_T_current});
    odom_.push_back({scan.stamp_ns(), motion.odom_T_current});
    if (gate_.add(motion)) {
      Keyframe keyframe;
      codes_.resize(static_cast<std::size_t>(gate_.beams(scan)));
      gate_.encode(scan, graph_.map_T_odom(), keyframe, codes_);
      gate_.accept();
      static_cast<void>(graph_.add(keyframe, codes_));
      while (graph_.work()) {
      }
    }
  }
  [[nodiscard]] const std::vector<StampedPose>& online() const { return online_; }
  [[nodiscard]] std::vector<StampedPose> finished() {
    graph_.finish();
    return graph_.corrected(odom_);
  }

 private:
  RobotLimits limits_;
  LaserOdometry odometry_;
  KeyframeGate gate_;
  SubmapGraph graph_;
  Rng rng_;
  std::vector<StampedPose> online_;
  std::vector<StampedPose> odom_;
  std::vector<BeamCode> codes_;
};

py::tuple replay(const py::array_t<double, py::array::c_style | py::array::forcecast>& stamps_s, const Ranges& ranges_m,
                 const Laser& laser, std::uint64_t seed) {
  if (ranges_m.ndim() != 2 || stamps_s.ndim() != 1 || stamps_s.shape(0) != ranges_m.shape(0)) {
    throw py::value_error("ranges_m must have a row per scan, and stamps_s one stamp per row");
  }
  const auto beams = static_cast<std::size_t>(ranges_m.shape(1));
  const ScanParams params = laser.params(ranges_m.shape(1));
  ScanFrame frame(params);
  Replay run(params, seed);
  for (py::ssize_t i = 0; i < stamps_s.shape(0); ++i) {
    assign(frame, laser, stamps_s.data()[i], {ranges_m.data(i, 0), beams});
    const py::gil_scoped_release free;
    run.add(frame);
  }
  const Poses online = to_array(run.online());
  return py::make_tuple(to_array(run.finished()), online);
}

}  // namespace
}  // namespace odoless

PYBIND11_MODULE(odoless, module) {
  module.doc() = "SLAM with one laser range finder and no odometry.";
  py::class_<odoless::Laser>(module, "Laser",
                             "What all scans of a laser have in common; 0 rad is the front, positive to the left.")
      .def(py::init([](double start_angle_rad, double angle_step_rad, double range_max_m) {
             return odoless::Laser{start_angle_rad, angle_step_rad, range_max_m};
           }),
           py::arg("start_angle_rad"), py::arg("angle_step_rad"), py::arg("range_max_m") = 30.0);
  module.def(
      "replay", &odoless::replay, py::arg("stamps_s"), py::arg("ranges_m"), py::arg("laser"), py::arg("seed") = 1,
      "Trajectory of an array of scans, a row per scan. Returns (final, online), each with rows (x_m, y_m, yaw_rad) "
      "in\n"
      "the map frame, which begins at the first scan: final is smoothed with all loop closures, online is as known at\n"
      "the time. Ranges that are not numbers, 0 or less are not known; infinite ones are no return. The same scans "
      "and\n"
      "random seed give the same numbers.");
}
