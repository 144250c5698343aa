// Figures 5.24 to 5.29: DP-SLAM in simulated buildings (section 5.3).
#include "config/config.hpp"
#include "tools/eval/report.hpp"
#include "tools/experiment/builtin_files.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/path_claims.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/seed_runs.hpp"

namespace odoless {
namespace {

/// The dissertation's counts of particles, or a tenth of them.
Run mapping_run(const std::string& name, const std::string& world, Extent extent) {
  constexpr int kQuickDivisor = 10;
  Run run;
  run.kind = Run::Kind::kMapping;
  run.scene = {.world = world, .lrf = {.noise_sd_m = kSeedNoiseM}};
  parse_parameters(builtin_file("seed-simulated.toml"), "seed-simulated.toml", run.params);
  if (extent == Extent::kQuick) {
    run.params.slam.low.particles /= kQuickDivisor;
    run.params.slam.high.particles /= kQuickDivisor;
  }
  run.name = name;
  return run;
}

/// The path as displacements, to be compared as matches are.
std::vector<MatchRow> displacements_of(std::span<const Pose2> poses) {
  std::vector<MatchRow> rows;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    MatchRow row;
    row.reference_index = static_cast<int>(i - 1);
    row.index = static_cast<int>(i);
    row.reference_T_scan = poses[i - 1].inverse() * poses[i];
    rows.push_back(row);
  }
  return rows;
}

Figure histogram_figure(const std::string& number, const std::string& axis, std::span<const double> errors,
                        double limit) {
  return {.name = "figure-" + number,
          .caption = "Figure " + number + ": distribution of the error in " + axis + " with DP-SLAM",
          .panels = {histogram_panel("per displacement", "error in " + axis, errors, limit)}};
}

std::vector<Figure> histograms(std::span<const DisplacementError> errors) {
  constexpr double kLimitM = 0.1;
  constexpr double kLimitDeg = 1.0;
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> yaw_deg;
  for (const DisplacementError& error : errors) {
    x_m.push_back(error.x_m);
    y_m.push_back(error.y_m);
    yaw_deg.push_back(to_deg(error.yaw_rad));
  }
  return {histogram_figure("5.26", "delta x (m)", x_m, kLimitM), histogram_figure("5.27", "delta y (m)", y_m, kLimitM),
          histogram_figure("5.28", "delta theta (deg)", yaw_deg, kLimitDeg)};
}

/// The map with the estimated and the true path, all in the map's own frame.
Chart mapped_panel(const RunOutput& output, std::span<const ReferencePose> truth) {
  const Pose2 map_T_world = output.trajectory.front().pose * truth.front().pose.inverse();
  std::vector<Pose2> map_truth;
  for (const ReferencePose& pose : truth) {
    map_truth.push_back(map_T_world * pose.pose);
  }
  return map_panel(
      "occupancy, and the paths", output.map,
      {path_series("true", map_truth, kRed), path_series("estimated", poses_of(output.trajectory), kBlue)});
}

Table path_table(std::span<const Pose2> estimate, std::span<const double> errors_m) {
  Table table{"path", {"pose", "x_m", "y_m", "yaw_rad", "error_m"}, {}};
  for (std::size_t i = 0; i < errors_m.size(); ++i) {
    table.rows.push_back({static_cast<double>(i), estimate[i].x_m, estimate[i].y_m, estimate[i].yaw_rad, errors_m[i]});
  }
  return table;
}

Findings conclude_dpslam(const Evidence& evidence) {
  const std::string& name = evidence.runs()[0].name;
  const RunOutput output = evidence.output(name);
  const std::vector<ReferencePose> truth = evidence.scene(name).truth.poses;
  const std::vector<Pose2> estimate = placed(output.trajectory, truth.front().pose);
  const std::vector<double> errors_m = position_errors_m(estimate, truth);
  const std::vector<Pose2> by_matches = chain(evidence.output(evidence.runs()[1].name).matches, truth.front().pose);
  Findings findings;
  findings.figures = {
      {.name = "figure-5.24", .caption = "Figure 5.24: map by DP-SLAM", .panels = {mapped_panel(output, truth)}},
      {.name = "figure-5.25",
       .caption = "Figure 5.25: error of position with DP-SLAM",
       .panels = {position_error_panel(errors_m, arrivals(truth, rooms_places()))}}};
  for (Figure& figure : histograms(displacement_errors(displacements_of(estimate), truth))) {
    findings.figures.push_back(std::move(figure));
  }
  findings.tables = {path_table(estimate, errors_m)};
  findings.claims = {error_is_mostly_small(errors_m), error_does_not_grow(errors_m),
                     filter_beats_matches(errors_m, position_errors_m(by_matches, truth)), error_is_tiny(errors_m)};
  return findings;
}

Findings conclude_office(const Evidence& evidence) {
  const std::string& name = evidence.runs()[0].name;
  const RunOutput output = evidence.output(name);
  const std::vector<ReferencePose> truth = evidence.scene(name).truth.poses;
  const std::vector<Pose2> estimate = placed(output.trajectory, truth.front().pose);
  const std::vector<double> errors_m = position_errors_m(estimate, truth);
  Findings findings;
  findings.figures = {{.name = "figure-5.29",
                       .caption = "Figure 5.29: map of another simulated building by hierarchical DP-SLAM",
                       .panels = {mapped_panel(output, truth)}},
                      {.name = "error",
                       .caption = "Not in the dissertation: its error of position",
                       .panels = {position_error_panel(errors_m, {})}}};
  findings.tables = {path_table(estimate, errors_m)};
  Claim claim = error_is_mostly_small(errors_m);
  claim.figure = "5.29";
  claim.stated = "the hierarchical filter gives the better map (taken as: error mostly under 300 mm)";
  findings.claims = {claim};
  return findings;
}

}  // namespace

std::vector<Experiment> mapping_experiments(Extent extent) {
  constexpr int kOfficeParticles = 1000;
  constexpr std::int64_t kQuickOfficeScans = 200;
  Run office = mapping_run("office-dpslam", "office.world", extent);
  if (extent == Extent::kFull) {
    office.params.slam.high.particles = kOfficeParticles;
  } else {
    office.scene.scans_max = kQuickOfficeScans;
  }
  return {
      {"dpslam",
       "5.24-5.28",
       "DP-SLAM in the building of Figure 5.8",
       {mapping_run("rooms-dpslam", "rooms.world", extent), seed_pairs(kSeedPopulation, kSeedGenerations, kSeedNoiseM)},
       conclude_dpslam},
      {"dpslam-office", "5.29", "DP-SLAM in another simulated building", {office}, conclude_office}};
}

}  // namespace odoless
