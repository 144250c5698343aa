// Figures 5.7 to 5.9: the path and the map that matches alone give in the simulated building.
#include <fmt/format.h>

#include "tools/experiment/groups.hpp"
#include "tools/experiment/path_claims.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/seed_runs.hpp"

namespace odoless {
namespace {

constexpr double kPointMapResolutionM = 0.02;

/// The indices at which Figure 5.8 cuts the route: A B C A, then D B, then A C B D. What a short run lacks stays away.
std::vector<std::size_t> cuts(std::span<const Arrival> route, std::size_t poses) {
  constexpr std::size_t kFirstPart = 4;
  constexpr std::size_t kSecondPart = 6;
  std::vector<std::size_t> indices{0};
  for (const std::size_t visits : {kFirstPart, kSecondPart}) {
    if (route.size() > visits && route[visits - 1].index < poses) {
      indices.push_back(route[visits - 1].index);
    }
  }
  indices.push_back(poses - 1);
  return indices;
}

Figure path_figure(std::span<const Pose2> truth, std::span<const Pose2> estimate, std::span<const Arrival> route) {
  Figure figure{.name = "figure-5.8", .caption = "Figure 5.8: true and estimated path", .columns = 3, .panels = {}};
  const std::vector<std::size_t> indices = cuts(route, estimate.size());
  for (std::size_t i = 0; i + 1 < indices.size(); ++i) {
    const std::size_t count = indices[i + 1] - indices[i] + 1;
    figure.panels.push_back({.title = fmt::format("poses {} to {}", indices[i], indices[i + 1]),
                             .x_label = "x (m)",
                             .y_label = "y (m)",
                             .series = {path_series("true", truth.subspan(indices[i], count), kRed),
                                        path_series("estimated", estimate.subspan(indices[i], count), kBlue)},
                             .alike = true});
  }
  return figure;
}

Table path_table(std::span<const Pose2> truth, std::span<const Pose2> estimate, std::span<const double> errors_m) {
  Table table{"paths", {"pose", "true_x_m", "true_y_m", "true_yaw_rad", "x_m", "y_m", "yaw_rad", "error_m"}, {}};
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    table.rows.push_back({static_cast<double>(i), truth[i].x_m, truth[i].y_m, truth[i].yaw_rad, estimate[i].x_m,
                          estimate[i].y_m, estimate[i].yaw_rad, errors_m[i]});
  }
  return table;
}

Findings conclude_drift(const Evidence& evidence) {
  const std::string& run = evidence.runs().front().name;
  const SceneData scene = evidence.scene(run);
  const std::vector<Pose2> truth = poses_of(scene.truth.poses);
  const std::vector<Pose2> estimate = chain(evidence.output(run).matches, truth.front());
  const std::vector<double> errors_m = position_errors_m(estimate, scene.truth.poses);
  const std::vector<Arrival> route = arrivals(scene.truth.poses, rooms_places());
  Findings findings;
  findings.figures = {
      {.name = "figure-5.7",
       .caption = "Figure 5.7: accumulated error due to imperfect scan matching",
       .panels = {position_error_panel(errors_m, route)}},
      path_figure(truth, estimate, route),
      {.name = "figure-5.9",
       .caption = "Figure 5.9: map by scan matching alone",
       .panels = {map_panel("returns of all scans", map_of_points(scene.log, estimate, kPointMapResolutionM),
                            {path_series("estimated path", estimate, kBlue)})}}};
  findings.tables = {path_table(truth, estimate, errors_m)};
  findings.claims = {error_accumulates(errors_m)};
  return findings;
}

}  // namespace

std::vector<Experiment> drift_experiments(Extent) {
  return {{"drift",
           "5.7-5.9",
           "Scan matching alone",
           {seed_pairs(kSeedPopulation, kSeedGenerations, kSeedNoiseM)},
           conclude_drift}};
}

}  // namespace odoless
