// The Python module `odoless`: arrays of scans in, arrays of poses out, by the library for C. README.md says how.

#include <odoless.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace py = pybind11;

namespace {

using Ranges = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Stamps = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Poses = py::array_t<double>;

/// What all scans have in common.
struct Laser {
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
};

/// ValueError for what is refused, RuntimeError for what could not be done.
void require(odoless_status status) {
  if (status == ODOLESS_OK) {
    return;
  }
  if (status == ODOLESS_NO_MEMORY || status == ODOLESS_FAILED) {
    throw std::runtime_error(odoless_last_error());
  }
  throw py::value_error(odoless_last_error());
}

std::int64_t to_ns(double stamp_s) {
  if (!std::isfinite(stamp_s) || std::abs(stamp_s) > 4e9) {
    throw py::value_error("a stamp must be a number of seconds within +-4e9");
  }
  return std::llround(1e9 * stamp_s);
}

Poses to_array(const std::vector<odoless_pose>& poses) {
  Poses out({static_cast<py::ssize_t>(poses.size()), py::ssize_t{3}});
  auto rows = out.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const odoless_pose& pose = poses[static_cast<std::size_t>(i)];
    rows(i, 0) = pose.x_m;
    rows(i, 1) = pose.y_m;
    rows(i, 2) = pose.yaw_rad;
  }
  return out;
}

/// A slam that is run without the interpreter's lock.
class Replay {
 public:
  Replay(const std::string& config, std::uint64_t seed) : slam_(create(config, seed), &odoless_destroy) {}

  void add(std::int64_t stamp_ns, const Laser& laser, const float* ranges_m, std::size_t beams) {
    odoless_estimate estimate{};
    require(unlocked([&] {
      const odoless_scan scan{stamp_ns, laser.start_angle_rad, laser.angle_step_rad, ranges_m, beams};
      const odoless_status status = odoless_add_scan(slam_.get(), &scan);
      return status == ODOLESS_OK ? odoless_get_estimate(slam_.get(), &estimate) : status;
    }));
    online_.push_back(estimate.pose);
  }
  [[nodiscard]] const std::vector<odoless_pose>& online() const { return online_; }
  [[nodiscard]] std::vector<odoless_pose> finished() {
    std::vector<odoless_pose> poses(online_.size());
    std::size_t count = 0;
    require(unlocked([&] { return odoless_finish(slam_.get()); }));
    require(odoless_get_trajectory(slam_.get(), poses.data(), poses.size(), &count));
    return poses;
  }

 private:
  static odoless_slam* create(const std::string& config, std::uint64_t seed) {
    odoless_slam* slam = nullptr;
    require(odoless_create(config.c_str(), seed, &slam));
    return slam;
  }
  template <class Call>
  static odoless_status unlocked(const Call& call) {
    const py::gil_scoped_release free;
    return call();
  }

  std::unique_ptr<odoless_slam, decltype(&odoless_destroy)> slam_;
  std::vector<odoless_pose> online_;
};

py::tuple replay(const Stamps& stamps_s, const Ranges& ranges_m, const Laser& laser, std::uint64_t seed,
                 const std::string& config) {
  if (ranges_m.ndim() != 2 || stamps_s.ndim() != 1 || stamps_s.shape(0) != ranges_m.shape(0)) {
    throw py::value_error("ranges_m must have a row per scan, and stamps_s one stamp per row");
  }
  Replay run(config, seed);
  for (py::ssize_t i = 0; i < stamps_s.shape(0); ++i) {
    run.add(to_ns(stamps_s.data()[i]), laser, ranges_m.data(i, 0), static_cast<std::size_t>(ranges_m.shape(1)));
  }
  return py::make_tuple(to_array(run.finished()), to_array(run.online()));
}

}  // namespace

PYBIND11_MODULE(odoless, module) {
  module.doc() = "SLAM with one laser range finder and no odometry.";
  py::class_<Laser>(module, "Laser",
                    "What all scans of a laser have in common; 0 rad is the front, positive to the left.")
      .def(py::init([](double start_angle_rad, double angle_step_rad) {
             return Laser{start_angle_rad, angle_step_rad};
           }),
           py::arg("start_angle_rad"), py::arg("angle_step_rad"));
  module.def(
      "replay", &replay, py::arg("stamps_s"), py::arg("ranges_m"), py::arg("laser"), py::arg("seed") = 1,
      py::arg("config") = "",
      "Trajectory of an array of scans, a row per scan, as `odoless replay` has it. Returns (final, online), each with "
      "rows\n"
      "(x_m, y_m, yaw_rad) in the map frame, which begins at the first scan: final is smoothed with all loop "
      "closures,\n"
      "online is as known at the time. Ranges that are not numbers, 0 or less are not known; infinite ones are no "
      "return.\n"
      "config is the text of a configuration file. The same scans, configuration and random seed give the same "
      "numbers.");
}
