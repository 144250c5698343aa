// Figures 5.19 to 5.23: how matches err, and the motion model's constants (section 5.2).
#include <fmt/format.h>

#include "tools/eval/report.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/motion_claims.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/recorded_scenes.hpp"
#include "tools/experiment/seed_runs.hpp"

namespace odoless {
namespace {

std::vector<DisplacementError> errors_of(const Evidence& evidence, const Run& run) {
  return displacement_errors(evidence.output(run.name).matches, evidence.scene(run.name).truth.poses);
}

std::vector<double> component(std::span<const DisplacementError> errors, double DisplacementError::*member) {
  std::vector<double> values;
  for (const DisplacementError& error : errors) {
    values.push_back(error.*member);
  }
  return values;
}

std::vector<double> in_deg(std::vector<double> angles_rad) {
  for (double& value : angles_rad) {
    value = to_deg(value);
  }
  return angles_rad;
}

Table error_table(std::span<const DisplacementError> errors) {
  Table table{
      "errors", {"pose", "true_dx_m", "true_dy_m", "true_dyaw_rad", "error_x_m", "error_y_m", "error_yaw_rad"}, {}};
  for (const DisplacementError& error : errors) {
    // In the dissertation's axes, as the errors: x is to the right.
    table.rows.push_back({static_cast<double>(error.index), -error.true_motion.y_m, error.true_motion.x_m,
                          error.true_motion.yaw_rad, error.x_m, error.y_m, error.yaw_rad});
  }
  return table;
}

Findings conclude_distribution(const Evidence& evidence) {
  constexpr double kLimitM = 0.05;
  constexpr double kLimitDeg = 0.5;
  const std::vector<DisplacementError> errors = errors_of(evidence, evidence.runs().front());
  const std::vector<double> x_m = component(errors, &DisplacementError::x_m);
  const std::vector<double> y_m = component(errors, &DisplacementError::y_m);
  const std::vector<double> yaw_deg = in_deg(component(errors, &DisplacementError::yaw_rad));
  Findings findings;
  findings.figures = {{.name = "figure-5.19",
                       .caption = "Figure 5.19: distribution of the errors in displacement",
                       .panels = {histogram_panel("a) across the heading", "error in delta x (m)", x_m, kLimitM),
                                  histogram_panel("b) rotation", "error in delta theta (deg)", yaw_deg, kLimitDeg),
                                  histogram_panel("c) along the heading", "error in delta y (m)", y_m, kLimitM)}}};
  findings.tables = {error_table(errors)};
  findings.claims = {errors_look_normal("5.19a", "delta x (m)", x_m),
                     errors_look_normal("5.19b", "delta theta (deg)", yaw_deg),
                     errors_look_normal("5.19c", "delta y (m), its large part", y_m), spreads_cover_errors(errors)};
  return findings;
}

Findings conclude_rotation(const Evidence& evidence) {
  const std::vector<MatchRow> matches = evidence.output(evidence.runs().front().name).matches;
  Series series{"displacements of D-Wing", Mark::kPoints, kBlue, {}};
  Table table{"displacements", {"scan", "dy_m", "dyaw_deg"}, {}};
  for (const MatchRow& match : matches) {
    const Pose2& motion = match.reference_T_scan;
    series.points.push_back({to_deg(motion.yaw_rad), motion.x_m});
    table.rows.push_back({static_cast<double>(match.index), motion.x_m, to_deg(motion.yaw_rad)});
  }
  Findings findings;
  findings.figures = {{.name = "figure-5.23",
                       .caption = "Figure 5.23: displacement along the heading over rotation (D-Wing)",
                       .panels = {{.x_label = "delta theta (deg)", .y_label = "delta y (m)", .series = {series}}}}};
  findings.tables = {table};
  findings.claims = {long_displacements_turn_little(matches)};
  return findings;
}

/// Travel that the matches report over the true one, with lambda, the speed's promise, as the diagonal.
Chart travel_panel(std::span<const DisplacementError> errors) {
  Chart panel{.title = "travel per displacement in a corridor without a feature",
              .x_label = "scan",
              .y_label = "travel (m)",
              .series = {{"true: lambda", Mark::kLine, kRed, {}}, {"by the match", Mark::kPoints, kBlue, {}}}};
  for (const DisplacementError& error : errors) {
    const auto scan = static_cast<double>(error.index);
    panel.series[0].points.push_back({scan, error.true_motion.x_m});
    panel.series[1].points.push_back({scan, error.true_motion.x_m + error.y_m});
  }
  return panel;
}

Findings conclude_travel(const Evidence& evidence) {
  constexpr double kPointMapResolutionM = 0.02;
  constexpr double kLimitM = 0.4;
  const Run& run = evidence.runs().front();
  const std::vector<DisplacementError> errors = errors_of(evidence, run);
  const SceneData scene = evidence.scene(run.name);
  const std::vector<Pose2> path = chain(evidence.output(run.name).matches, scene.truth.poses.front().pose);
  const OccupancyMap map = map_of_points(scene.log, path, kPointMapResolutionM);
  Findings findings;
  findings.figures = {
      {.name = "figure-5.20",
       .caption = "Figure 5.20 and 5.22: misalignment along the heading",
       .panels = {map_panel(
           "returns of all scans", map,
           {path_series("true path", poses_of(scene.truth.poses), kRed), path_series("matches", path, kBlue)})}},
      {.name = "figure-5.21",
       .caption = "Figure 5.21: displacement by scan matching, and the true one",
       .panels = {travel_panel(errors), histogram_panel("error along the heading", "error in delta y (m)",
                                                        component(errors, &DisplacementError::y_m), kLimitM)}}};
  findings.tables = {error_table(errors)};
  findings.claims = {corridor_hides_travel(errors), corridor_holds_across(errors)};
  return findings;
}

/// A laser of 8 m never sees the corridor's ends.
Run corridor_run(Extent extent) {
  constexpr double kRangeMaxM = 8.0;
  Run run;
  run.name = "corridor-seed";
  run.scene = {.world = "corridor.world", .lrf = {.range_max_m = kRangeMaxM, .noise_sd_m = kSeedNoiseM}};
  run.scene.scans_max = extent == Extent::kQuick ? kQuickRecordedScans : 0;
  run.params.matcher = seed_matcher(kSeedPopulation, kSeedGenerations);
  return run;
}

}  // namespace

std::vector<Experiment> motion_experiments(Extent extent) {
  Run dwing;
  dwing.name = "dwing-default";
  dwing.scene = dwing_scene();
  dwing.scene.scans_max = extent == Extent::kQuick ? kQuickRecordedScans : 0;
  return {{"errors",
           "5.19",
           "How matches err, and the motion model's constants",
           {seed_pairs(kSeedPopulation, kSeedGenerations, kSeedNoiseM)},
           conclude_distribution},
          {"travel", "5.20-5.22", "Travel along a corridor without a feature", {corridor_run(extent)}, conclude_travel},
          {"rotation", "5.23", "Displacement and rotation in D-Wing", {dwing}, conclude_rotation}};
}

}  // namespace odoless
