#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "core/match/ndt_matcher.hpp"
#include "core/odometry/laser_odometry.hpp"
#include "tests/bench/bench_pair.hpp"

namespace odoless {
namespace {

constexpr int kPoses = 256;

// The poses that both forms of the score are asked: anywhere in the default search box.
std::vector<Pose2> random_poses() {
  const SearchParams box;
  Rng rng(1);
  std::vector<Pose2> poses;
  for (int i = 0; i < kPoses; ++i) {
    poses.push_back({rng.uniform(-box.box_translation_m, box.box_translation_m),
                     rng.uniform(-box.box_translation_m, box.box_translation_m),
                     rng.uniform(-box.box_rotation_rad, box.box_rotation_rad)});
  }
  return poses;
}

PointSet all_returns(const ScanFrame& scan) {
  PointSet points(scan.size());
  append_thinned(scan, {}, 0.0, points);
  return points;
}

// Runs `score(points, pose)` over all poses of the list; items are point evaluations.
template <class Score>
void score_poses(benchmark::State& state, Score&& score) {
  const PointSet points = all_returns(bench_pair().scan);
  const std::vector<Pose2> poses = random_poses();
  for (auto _ : state) {
    double sum = 0.0;
    for (const Pose2& pose : poses) {
      sum += score(points, pose);
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * kPoses * points.size());
  state.SetLabel(bench_pair().label);
}

// The exact score: four grids, an exponential per grid.
void plain_score(benchmark::State& state) {
  Ndt ndt(NdtParams{}, bench_pair().reference.size());
  ndt.rebuild(all_returns(bench_pair().reference));
  score_poses(state, [&](const PointSet& points, const Pose2& pose) { return ndt.score(points, pose); });
}
BENCHMARK(plain_score)->Name("BM_NdtScore/plain")->Unit(benchmark::kMicrosecond);

// What the search asks: one look-up in the fine raster.
void product_score(benchmark::State& state) {
  Ndt ndt(NdtParams{}, bench_pair().reference.size());
  ndt.rebuild(all_returns(bench_pair().reference));
  ScoreRaster raster(ReferenceParams{}.fine);
  raster.paint(ndt);
  score_poses(
      state, [&](const PointSet& points, const Pose2& pose) { return raster.score(points.x_m(), points.y_m(), pose); });
}
BENCHMARK(product_score)->Name("BM_NdtScore/product")->Unit(benchmark::kMicrosecond);

// One match of the pair, with the making of its reference.
void match_pair(benchmark::State& state, const MatcherParams& params) {
  const BenchPair& pair = bench_pair();
  MatchReference reference(params.reference, params.points_max);
  NdtMatcher matcher(params);
  const PlacedScan placed{&pair.reference, {}};
  std::int64_t evaluations = 0;
  double fitness = 0.0;
  std::uint64_t seed = 0;
  for (auto _ : state) {
    Rng rng(seed++);
    static_cast<void>(reference.rebuild({&placed, 1}));
    const MatchResult result = matcher.match(reference, pair.scan, {}, {}, rng).value();
    evaluations += result.evaluations;
    fitness = result.fitness;
  }
  state.counters["evaluations"] =
      benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kAvgIterations);
  state.counters["fitness"] = fitness;
  state.SetLabel(pair.label);
}

// The dissertation's N = 100, G = 50, looked up in the raster as the product does.
void BM_SeedMatch(benchmark::State& state) {
  MatcherParams params = seed_matcher_params();
  params.search.exact = false;
  match_pair(state, params);
}
BENCHMARK(BM_SeedMatch)->Unit(benchmark::kMillisecond);

// The same on the exact score, as the dissertation did.
void BM_ExactSeedMatch(benchmark::State& state) { match_pair(state, seed_matcher_params()); }
BENCHMARK(BM_ExactSeedMatch)->Unit(benchmark::kMillisecond);

void BM_Match(benchmark::State& state) { match_pair(state, {}); }
BENCHMARK(BM_Match)->Unit(benchmark::kMillisecond);

void rebuild(benchmark::State& state, const ReferenceParams& params, int scans) {
  const double key_distance_m = LaserOdometryParams{}.key_distance_m;
  std::vector<PlacedScan> placed;
  for (int i = 0; i < scans; ++i) {
    placed.push_back({&bench_pair().reference, {-i * key_distance_m, 0.0, 0.0}});
  }
  MatchReference reference(params, MatcherParams{}.points_max * scans);
  for (auto _ : state) {
    benchmark::DoNotOptimize(reference.rebuild(placed));
  }
  state.SetLabel(bench_pair().label);
}

// Of one scan.
void BM_ReferenceRebuild(benchmark::State& state) { rebuild(state, MatcherParams{}.reference, 1); }
BENCHMARK(BM_ReferenceRebuild)->Unit(benchmark::kMillisecond);

// Of as many key scans as the odometry keeps: what one scan in ten costs beside its match.
void BM_LocalMapRebuild(benchmark::State& state) {
  rebuild(state, local_map_params(), LaserOdometryParams{}.key_scans);
}
BENCHMARK(BM_LocalMapRebuild)->Unit(benchmark::kMillisecond);

// To and fro between the two scans: each step matches, and most make a key scan.
void BM_LaserOdometry(benchmark::State& state) {
  const BenchPair& pair = bench_pair();
  LaserOdometry odometry({}, {}, {}, {});
  Rng rng(1);
  bool forth = false;
  for (auto _ : state) {
    forth = !forth;
    ScanFrame scan = forth ? pair.reference : pair.scan;
    benchmark::DoNotOptimize(odometry.process(scan, {}, rng));
  }
  state.SetLabel(pair.label);
}
BENCHMARK(BM_LaserOdometry)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace odoless
