// Figures 5.30 to 5.33: DP-SLAM on recorded logs (section 5.3).
#include <fmt/format.h>

#include "config/config.hpp"
#include "tools/eval/ate.hpp"
#include "tools/eval/relations.hpp"
#include "tools/eval/report.hpp"
#include "tools/experiment/builtin_files.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/recorded_scenes.hpp"

namespace odoless {
namespace {

/// What is printed in the dissertation for one of its logs.
struct SeedCounts {
  int low_particles = 0;
  int high_particles = 0;
  double resolution_m = 0.05;
};

Run recorded_mapping(const std::string& name, Scene scene, const SeedCounts& counts, Extent extent) {
  constexpr int kQuickDivisor = 10;
  constexpr int kAllBeams = 16384;
  constexpr int kTiles = 65536;
  const int divisor = extent == Extent::kQuick ? kQuickDivisor : 1;
  Run run;
  run.name = name;
  run.kind = Run::Kind::kMapping;
  run.scene = std::move(scene);
  run.scene.scans_max = extent == Extent::kQuick ? kQuickRecordedScans : 0;
  run.params.slam.low.particles = counts.low_particles / divisor;
  run.params.slam.low.spread_error = 0.0;
  run.params.slam.low.beams_mapped = kAllBeams;
  run.params.slam.high.particles = counts.high_particles / divisor;
  run.params.slam.low.grid.resolution_m = counts.resolution_m;
  run.params.slam.high.grid.resolution_m = counts.resolution_m;
  run.params.slam.low.grid.tiles_max = run.params.slam.high.grid.tiles_max = kTiles;
  return run;
}

Table path_table(std::span<const ReferencePose> trajectory) {
  Table table{"path", {"stamp_s", "x_m", "y_m", "yaw_rad"}, {}};
  for (const ReferencePose& pose : trajectory) {
    table.rows.push_back({pose.stamp_s, pose.pose.x_m, pose.pose.y_m, pose.pose.yaw_rad});
  }
  return table;
}

Findings map_findings(const RunOutput& output, const std::string& number) {
  Findings findings;
  findings.figures = {{.name = "figure-" + number,
                       .caption = "Figure " + number + ": map by DP-SLAM",
                       .panels = {map_panel("occupancy, and the path", output.map,
                                            {path_series("path", poses_of(output.trajectory), kBlue)})}}};
  findings.tables = {path_table(output.trajectory)};
  return findings;
}

constexpr const char* kConsistent = "DP-SLAM gives a consistent map";

/// Consistent: the path is on average no further than that from the reference's.
Claim agrees_with_reference(const std::string& figure, const AteResult& ate, double rms_max_m) {
  const double rms_m = ate.errors.translation_m.root_mean_square;
  return {figure, fmt::format("{} (taken as: RMS distance from a reference path at most {} m)", kConsistent, rms_max_m),
          fmt::format("RMS {:.3f} m, largest {:.2f} m over {} poses", rms_m, ate.errors.translation_m.max, ate.used),
          ate.used > 0 && rms_m <= rms_max_m};
}

AteResult ate_of(const Evidence& evidence, const RunOutput& output) {
  constexpr double kToleranceS = 0.05;
  ReferencePoses truth = evidence.scene(evidence.runs().front().name).truth;
  for (std::size_t i = 0; !truth.has_stamps && i < truth.poses.size(); ++i) {  // then the log's are these, too
    truth.poses[i].stamp_s = static_cast<double>(i) * static_cast<double>(kDefaultPeriodNs) * 1e-9;
  }
  return evaluate_ate(truth.poses, output.trajectory, {.tolerance_s = kToleranceS});
}

Claim agrees_with_relations(const std::string& figure, const RelationsResult& result) {
  constexpr double kMeanMaxM = 0.1;
  const double mean_m = result.errors.translation_m.mean;
  return {figure,
          fmt::format("{} (taken as: mean error of the verified relations at most {} m)", kConsistent, kMeanMaxM),
          fmt::format("mean {:.3f} m, {:.2f} deg over {} relations", mean_m, to_deg(result.errors.rotation_rad.mean),
                      result.used),
          result.used > 0 && mean_m <= kMeanMaxM};
}

RelationsResult relations_of(const Evidence& evidence, const RunOutput& output) {
  const std::string& file = evidence.runs().front().scene.relations;
  return evaluate_relations(read_relations(evidence.sources().data / file), output.trajectory, {});
}

RunOutput output_of(const Evidence& evidence) { return evidence.output(evidence.runs().front().name); }

Findings conclude_dwing_map(const Evidence& evidence) {
  constexpr double kRmsMaxM = 0.3;
  const RunOutput output = output_of(evidence);
  Findings findings = map_findings(output, "5.30");
  findings.claims = {agrees_with_reference("5.30", ate_of(evidence, output), kRmsMaxM)};
  return findings;
}

Findings conclude_fr079(const Evidence& evidence) {
  const RunOutput output = output_of(evidence);
  Findings findings = map_findings(output, "5.31");
  findings.claims = {agrees_with_relations("5.31", relations_of(evidence, output))};
  return findings;
}

Findings conclude_aces(const Evidence& evidence) {
  const RunOutput output = output_of(evidence);
  Findings findings = map_findings(output, "5.32");
  findings.claims = {agrees_with_relations("5.32", relations_of(evidence, output))};
  return findings;
}

Findings conclude_orebro(const Evidence& evidence) {
  constexpr double kRmsMaxM = 1.0;
  const RunOutput output = output_of(evidence);
  Findings findings = map_findings(output, "5.33");
  findings.claims = {agrees_with_reference("5.33", ate_of(evidence, output), kRmsMaxM)};
  return findings;
}

}  // namespace

std::vector<Experiment> recorded_mapping_experiments(Extent extent) {
  constexpr SeedCounts kDWing{500, 600, 0.05};
  constexpr SeedCounts kCWing{600, 1300, 0.04};
  constexpr SeedCounts kDiiga{600, 1800, 0.04};
  constexpr SeedCounts kMine{1200, 0, 0.05};
  const auto mapping = [&](const char* name, Scene scene, const SeedCounts& counts) {
    return std::vector<Run>{recorded_mapping(name, std::move(scene), counts, extent)};
  };
  return {
      {"dpslam-dwing", "5.30", "DP-SLAM on D-Wing", mapping("dwing-dpslam", dwing_scene(), kDWing), conclude_dwing_map},
      {"dpslam-fr079", "5.31", "DP-SLAM on fr079 with C-Wing's particles",
       mapping("fr079-dpslam", fr079_scene(), kCWing), conclude_fr079},
      {"dpslam-aces", "5.32", "DP-SLAM on aces with Diiga's particles", mapping("aces-dpslam", aces_scene(), kDiiga),
       conclude_aces},
      {"dpslam-orebro", "5.33", "DP-SLAM on Orebro with Mine's particles",
       mapping("orebro-dpslam", orebro_scene(), kMine), conclude_orebro}};
}

}  // namespace odoless
