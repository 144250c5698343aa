// Not in the dissertation: DP-SLAM as built in, in worlds that are hard in other ways.
#include <array>

#include "tools/experiment/groups.hpp"
#include "tools/experiment/path_claims.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/seed_runs.hpp"

namespace odoless {
namespace {

struct HardWorld {
  const char* name;
  double range_max_m;
  bool is_told;  ///< whether its walls tell where the robot is
};

/// In the corridor and in the hall a laser of that range can't tell, and nobody could: their errors are shown, not
/// judged.
constexpr std::array kWorlds{HardWorld{"symmetric", 80.0, true}, HardWorld{"people", 80.0, true},
                             HardWorld{"cave", 80.0, true}, HardWorld{"hall", 30.0, false},
                             HardWorld{"corridor", 8.0, false}};

std::vector<double> errors_of(const Evidence& evidence, const std::string& run) {
  const std::vector<ReferencePose> truth = evidence.scene(run).truth.poses;
  return position_errors_m(placed(evidence.output(run).trajectory, truth.front().pose), truth);
}

Figure map_figure(const Evidence& evidence, const HardWorld& world, const std::string& run) {
  const RunOutput output = evidence.output(run);
  return {.name = std::string("map-") + world.name,
          .caption = std::string("Not in the dissertation: map of ") + world.name + ".world",
          .panels = {map_panel("occupancy, and the path", output.map,
                               {path_series("path", poses_of(output.trajectory), kBlue)})}};
}

Findings conclude_worlds(const Evidence& evidence) {
  constexpr std::array kColours{kRed, kBlue, kGreen, kOrange, Rgb{120, 94, 240}};
  Chart panel{.title = "distance from the true position", .x_label = "robot pose", .y_label = "error (mm)"};
  Table table{"errors", {"world", "pose", "error_m"}, {}};
  Findings findings;
  for (std::size_t w = 0; w < kWorlds.size(); ++w) {
    const std::string& run = evidence.runs()[w].name;
    const std::vector<double> errors_m = errors_of(evidence, run);
    panel.series.push_back(index_series(kWorlds.at(w).name, errors_m, 1e3, kColours.at(w)));
    for (std::size_t i = 0; i < errors_m.size(); ++i) {
      table.rows.push_back({static_cast<double>(w), static_cast<double>(i), errors_m[i]});
    }
    findings.figures.push_back(map_figure(evidence, kWorlds.at(w), run));
    if (kWorlds.at(w).is_told) {
      Claim claim = error_is_mostly_small(errors_m);
      claim.figure = kWorlds.at(w).name;
      claim.stated = "our aim: the error is kept mostly under 300 mm";
      findings.claims.push_back(claim);
    }
  }
  findings.figures.insert(
      findings.figures.begin(),
      {.name = "errors", .caption = "Not in the dissertation: error of position", .panels = {panel}});
  findings.tables = {table};
  return findings;
}

}  // namespace

std::vector<Experiment> world_experiments(Extent extent) {
  constexpr std::int64_t kQuickScans = 40;
  Experiment experiment{"worlds", "-", "Other worlds, as built in", {}, conclude_worlds};
  for (const HardWorld& world : kWorlds) {
    Run run;
    run.name = std::string("world-") + world.name;
    run.kind = Run::Kind::kMapping;
    run.scene = {.world = std::string(world.name) + ".world",
                 .lrf = {.range_max_m = world.range_max_m, .noise_sd_m = kSeedNoiseM},
                 .scans_max = extent == Extent::kQuick ? kQuickScans : 0};
    experiment.runs.push_back(run);
  }
  return {experiment};
}

}  // namespace odoless
