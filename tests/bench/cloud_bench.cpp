#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <vector>

#include "core/cloud/cloud_mapper.hpp"
#include "core/geometry/interpolated.hpp"
#include "tests/core/cloud/cloud_support.hpp"

namespace odoless {
namespace {

constexpr int kBeams = 1081;
constexpr double kRate_hz = 40.0;
constexpr int kScansPerNod = 60;

/// A nod of a laser that drives at 0.5 m/s in a hall: scans, angles and motions, over and over.
struct Nod {
  TiltMountParams mount{.robot_T_tilt = {.z_m = 0.6}, .tilt_T_laser = {.x_m = 0.05, .z_m = 0.03}};
  std::vector<ScanFrame> scans;
  std::vector<std::vector<double>> tilts_rad;

  Nod() {
    Rng rng(1);
    for (int i = 0; i < kScansPerNod; ++i) {
      std::vector<float> ranges_m;
      for (int beam = 0; beam < kBeams; ++beam) {
        ranges_m.push_back(static_cast<float>(6.0 + 3.0 * std::sin(0.01 * beam) + 0.01 * rng.normal()));
      }
      scans.push_back(test::scan_of(ranges_m));
      std::vector<double> angles_rad;
      for (int beam = 0; beam < kBeams; ++beam) {
        angles_rad.push_back(-0.5 + (i + static_cast<double>(beam) / kBeams) / kScansPerNod);
      }
      tilts_rad.push_back(std::move(angles_rad));
    }
  }
  [[nodiscard]] static ScanMotion motion(std::int64_t scan) {
    const double x_m = 0.5 * static_cast<double>(scan % 4000) / kRate_hz;
    return {{x_m, 0.0, 0.0}, {x_m + 0.5 / kRate_hz, 0.0, 0.001}};
  }
};

void set_rates(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * kBeams);
  // Of a core, at 40 Hz: this many scans per second of CPU time, turned round.
  state.counters["core_share"] = benchmark::Counter(static_cast<double>(state.iterations()) / kRate_hz,
                                                    benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void BM_Cloud_product(benchmark::State& state) {
  const Nod nod;
  CloudMapper mapper({}, TiltMount(nod.mount), kBeams);
  std::int64_t scan = 0;
  for (auto _ : state) {
    const auto i = static_cast<std::size_t>(scan % kScansPerNod);
    mapper.add(nod.scans[i], nod.tilts_rad[i], Nod::motion(scan++), {});
    if (mapper.cloud().keys().size() > 1000) {
      mapper.cloud().clear();
      mapper.reset();
    }
  }
  set_rates(state);
}
BENCHMARK(BM_Cloud_product)->Name("BM_Cloud/product");

/// The chain of frames beam by beam, and a map of voxels.
void BM_Cloud_plain(benchmark::State& state) {
  const Nod nod;
  std::map<std::tuple<int, int, int>, CloudPoint> voxels;
  std::int64_t scan = 0;
  for (auto _ : state) {
    const auto i = static_cast<std::size_t>(scan % kScansPerNod);
    const ScanMotion motion = Nod::motion(scan++);
    for (int beam = 0; beam < kBeams; ++beam) {
      const Pose2 pose = interpolated(motion.target_T_first, motion.target_T_last, beam / (kBeams - 1.0));
      const Point3 p =
          test::plain_end(nod.mount, nod.scans[i], beam, nod.tilts_rad[i][static_cast<std::size_t>(beam)], pose);
      const auto index = [](double value_m) { return static_cast<int>(std::floor(value_m / 0.05)); };
      ++voxels[{index(p.x_m), index(p.y_m), index(p.z_m)}].returns;
    }
    if (voxels.size() > 1'000'000) {
      voxels.clear();
    }
  }
  set_rates(state);
}
BENCHMARK(BM_Cloud_plain)->Name("BM_Cloud/plain");

}  // namespace
}  // namespace odoless
