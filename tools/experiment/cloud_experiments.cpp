// Figures 5.34 to 5.40: 3D maps of a laser that a servo tilts (section 5.4).
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tools/experiment/cloud_claims.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/output/cloud_picture.hpp"

namespace odoless {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr int kPictureSidePx = 640;

/// The colours of a picture's heights, as the entries of a legend.
std::vector<Series> height_legend(const HeightColours& colours) {
  std::vector<Series> legend;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double height_m = colours.low_m() + share * (colours.high_m() - colours.low_m());
    legend.push_back({fmt::format("{:.1f} m high", std::round(height_m * 10.0) / 10.0 + 0.0),
                      Mark::kPoints,
                      colours.at(height_m),
                      {}});
  }
  return legend;
}

Chart plan_panel(std::span<const Point3> points, const HeightColours& colours, std::span<const ReferencePose> path) {
  CloudPlan plan = plan_of_cloud(points, colours, below_ceiling_m(colours), kPictureSidePx);
  Chart chart{.title = "from above, without the ceiling",
              .x_label = "x (m)",
              .y_label = "y (m)",
              .series = height_legend(colours),
              .picture = Underlay{std::move(plan.canvas), plan.low.x_m, plan.low.y_m, 1.0 / plan.px_per_m}};
  chart.series.push_back(path_series("path of the laser", poses_of(path), {0, 0, 0}));
  return chart;
}

Chart perspective_panel(std::span<const Point3> points, const HeightColours& colours) {
  return {.title = "in perspective, without the ceiling",
          .series = height_legend(colours),
          .picture =
              Underlay{.canvas = draw_cloud_in_perspective(points, colours, below_ceiling_m(colours), kPictureSidePx)}};
}

Figure cloud_figure(const std::string& name, const std::string& caption, std::vector<Chart> panels) {
  const int columns = static_cast<int>(panels.size());
  return {.name = name, .caption = caption, .columns = columns, .panels = std::move(panels)};
}

/// Both views of what was seen from the first so many key poses, in the colours of the whole.
Figure keys_figure(const Evidence& evidence, const std::string& number, int keys, const CloudOutput& output) {
  const std::vector<Point3> points = read_cloud_of_keys(evidence.folder(evidence.runs()[0].name), keys);
  const HeightColours colours(output.points);
  return cloud_figure("figure-" + number,
                      fmt::format("Figure {}: what was seen from the first {} key poses only", number, keys),
                      {plan_panel(points, colours, {}), perspective_panel(points, colours)});
}

Figure whole_figure(const std::string& name, const std::string& caption, const CloudOutput& output) {
  const HeightColours colours(output.points);
  return cloud_figure(
      name, caption,
      {plan_panel(output.points, colours, output.trajectory), perspective_panel(output.points, colours)});
}

Findings conclude_building(const Evidence& evidence) {
  const CloudOutput output = read_cloud(evidence.folder(evidence.runs()[0].name));
  Findings findings;
  findings.figures = {whole_figure("figure-5.34", "Figure 5.34: 3D map of the simulated building", output),
                      keys_figure(evidence, "5.35", 3, output), keys_figure(evidence, "5.36", 4, output)};
  findings.tables = {output.sample};
  findings.claims = {projects_onto_surfaces("5.34",
                                            "the trajectory of 2D DP-SLAM can be used to project the 3D data (our aim: "
                                            "median error 20 mm, 95th percentile 60 mm)",
                                            output),
                     floor_is_flat("5.34", output)};
  return findings;
}

/// The mine is not public: our cave in its place, and a laser that nods while the robot drives, not stops.
Findings conclude_mine(const Evidence& evidence) {
  const CloudOutput output = read_cloud(evidence.folder(evidence.runs()[0].name));
  const HeightColours colours(output.points);
  Findings findings;
  findings.figures = {keys_figure(evidence, "5.37", 2, output), keys_figure(evidence, "5.38", 4, output),
                      cloud_figure("figure-5.39", "Figure 5.39: 3D map of a cave, from above",
                                   {plan_panel(output.points, colours, output.trajectory)}),
                      cloud_figure("figure-5.40", "Figure 5.40: 3D map of a cave, in perspective",
                                   {perspective_panel(output.points, colours)})};
  findings.tables = {output.sample};
  findings.claims = {
      most_scans_are_mapped("5.37-5.40", "a mine is mapped in 3D (a cave in its place, for the mine is not public)",
                            output),
      projects_onto_surfaces("5.37-5.40", "our aim in the cave: as in the building", output)};
  return findings;
}

Findings conclude_recorded(const Evidence& evidence) {
  Findings findings;
  for (const Run& run : evidence.runs()) {
    CloudOutput output = read_cloud(evidence.folder(run.name));
    findings.figures.push_back(
        whole_figure("recorded-" + run.name, "Not in the dissertation: " + run.scene.log, output));
    findings.claims.push_back(
        most_scans_are_mapped("-", run.scene.log + ": our aim: most scans of a recorded tilt log are mapped", output));
    output.sample.name = run.name;
    findings.tables.push_back(std::move(output.sample));
  }
  return findings;
}

Run cloud_run(const std::string& name) {
  Run run;
  run.name = name;
  run.kind = Run::Kind::kCloud;
  return run;
}

/// A laser of the kind that the product is for, which turns while the robot drives; a third of its beams, and the
/// beginning of the way, if it is to be quick.
Run simulated_run(const std::string& world, Extent extent) {
  constexpr int kQuickBeams = 361;
  constexpr std::int64_t kQuickScans = 800;
  Run run = cloud_run("cloud-" + world);
  run.scene = {.world = world + ".world", .lrf = simulated_lrf_params(*find_lrf_model("utm-30lx"))};
  run.scene.lrf.distortion = true;
  if (extent == Extent::kQuick) {
    run.scene.lrf.beams = kQuickBeams;
    run.scene.scans_max = kQuickScans;
  }
  return run;
}

/// They nod slowly and scan 3 to 5 times a second: poses are farther apart than on a robot.
Run recorded_run(const std::string& name, const std::string& log) {
  constexpr double kPoseGapMaxS = 30.0;
  Run run = cloud_run(name);
  run.scene.log = log;
  run.cloud.servo_level_rad = 90.0 * kDeg;
  run.cloud.mapping.pose_gap_max_s = kPoseGapMaxS;
  run.cloud.mapping.yaw_doubt_max_rad = 5.0 * kDeg;
  return run;
}

}  // namespace

std::vector<Experiment> cloud_experiments(Extent extent) {
  return {{"cloud",
           "5.34-5.36",
           "3D map of the building of Figure 5.8",
           {simulated_run("rooms", extent)},
           conclude_building},
          {"cloud-mine", "5.37-5.40", "3D map of a mine", {simulated_run("cave", extent)}, conclude_mine},
          {"cloud-recorded",
           "-",
           "3D maps of recorded tilt logs",
           {recorded_run("cloud-lidar-servo", "tilt-epfl-lidarServo.csv.xz"),
            recorded_run("cloud-servo-imu", "tilt-epfl-servo-imu-3hz.csv.xz")},
           conclude_recorded}};
}

}  // namespace odoless
