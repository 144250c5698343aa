#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/grid/grid_walk.hpp"
#include "core/slam/lslam.hpp"

namespace odoless {
namespace {

/// Ranges of a laser in a rectangular room of 10 m x 8 m with a door, with noise.
std::vector<float> room_ranges_m(const Pose2& map_T_scan, int beams, Rng& rng) {
  std::vector<float> ranges_m;
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = map_T_scan.yaw_rad - 0.5 * std::numbers::pi + i * std::numbers::pi / (beams - 1);
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    const double to_x_m = ((c > 0.0 ? 5.0 : -5.0) - map_T_scan.x_m) / c;
    const double to_y_m = ((s > 0.0 ? 4.0 : -4.0) - map_T_scan.y_m) / s;
    const bool door = to_x_m < to_y_m && std::abs(map_T_scan.y_m + to_x_m * s) < 0.5;
    ranges_m.push_back(static_cast<float>(std::min(to_x_m, to_y_m) + (door ? 3.0 : 0.0) + 0.01 * rng.normal()));
  }
  return ranges_m;
}

/// One update at ranges of about 5 m, while the robot wanders through the room.
void BM_LslamUpdate(benchmark::State& state) {
  const auto beams = static_cast<int>(state.range(1));
  LslamParams params;
  params.particles = static_cast<int>(state.range(0));
  params.beams_used = static_cast<int>(state.range(2));
  Lslam lslam(params, 1);
  Rng rng(2);
  ScanFrame scan(ScanParams{});
  Pose2 robot;
  const Pose2 step{0.05, 0.0, 0.02};
  std::int64_t stamp_ns = 0;
  const auto sweep = [&] {
    const std::vector<float> ranges_m = room_ranges_m(robot, beams, rng);
    static_cast<void>(scan.assign({.stamp_ns = stamp_ns,
                                   .start_angle_rad = -0.5 * std::numbers::pi,
                                   .angle_step_rad = std::numbers::pi / (beams - 1),
                                   .ranges_m = ranges_m}));
  };
  sweep();
  static_cast<void>(lslam.update({}, scan));
  for (auto _ : state) {
    state.PauseTiming();
    robot = robot * step;
    const Motion motion = Motion::between(stamp_ns, stamp_ns + 100'000'000, step);
    stamp_ns = motion.to_stamp_ns;
    sweep();
    state.ResumeTiming();
    benchmark::DoNotOptimize(lslam.update(motion, scan));
  }
  state.counters["tiles"] = lslam.tiles_used();
}
BENCHMARK(BM_LslamUpdate)
    ->ArgNames({"particles", "beams", "weighed"})
    ->Args({100, 180, 180})
    ->Args({100, 180, 60})
    ->Args({100, 360, 60})
    ->Args({1000, 180, 60})
    ->Unit(benchmark::kMillisecond);

void BM_GridWalk(benchmark::State& state) {
  std::int64_t cells = 0;
  double angle_rad = 0.0;
  for (auto _ : state) {
    angle_rad += 0.1;
    GridWalk walk({1000.3, 1000.6}, {std::cos(angle_rad), std::sin(angle_rad)}, 100.0);
    int sum = 0;
    do {
      sum += walk.cell().column() ^ walk.cell().row();
      ++cells;
    } while (walk.next());
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(cells);
}
BENCHMARK(BM_GridWalk);

}  // namespace
}  // namespace odoless
