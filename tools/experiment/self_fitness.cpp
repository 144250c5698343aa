#include "tools/experiment/self_fitness.hpp"

#include "core/ndt/ndt.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

std::vector<SelfScore> self_scores(const ScanLog& log, const RobotParams& params) {
  Ndt ndt(params.matcher.reference.ndt, params.matcher.points_max);
  PointSet points(params.matcher.points_max);
  ScanFrame frame(params.scan);
  std::vector<SelfScore> scores;
  for (const LogScan& scan : log.scans) {
    points.clear();
    if (frame.assign(scan.raw()) == Errc::kOk) {
      append_thinned(frame, {}, 0.0, points);
    }
    ndt.rebuild(points);
    scores.push_back({ndt.score(points, {}), points.size(), static_cast<int>(scan.ranges_m.size())});
  }
  return scores;
}

std::vector<double> seed_fitness(std::span<const MatchRow> matches, std::span<const SelfScore> of_scans) {
  constexpr double kBeams = 180.0;
  std::vector<double> fitness;
  for (const MatchRow& match : matches) {
    const SelfScore& reference = of_scans[static_cast<std::size_t>(match.reference_index)];
    const SelfScore& scan = of_scans[static_cast<std::size_t>(match.index)];
    fitness.push_back(kBeams / scan.beams * (reference.score - match.fitness * scan.returns));
  }
  return fitness;
}

}  // namespace odoless
