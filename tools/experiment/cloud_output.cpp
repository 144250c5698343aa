#include "tools/experiment/cloud_output.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/cloud/cloud_job.hpp"
#include "tools/experiment/builtin_files.hpp"
#include "tools/output/cloud_files.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr std::size_t kSampleMax = 20'000;

std::string keys_file(int keys) { return fmt::format("keys-{}.ply", keys); }

/// A built-in world becomes a file, which says what the run was made of.
std::string input_of(const Run& run, const Sources& sources, const std::filesystem::path& folder) {
  if (run.scene.world.empty()) {
    return (sources.data / run.scene.log).string();
  }
  const std::filesystem::path world = folder / run.scene.world;
  write_whole_file(world, builtin_file(run.scene.world));
  return world.string();
}

CloudJob job_of(const Run& run, const Sources& sources, const std::filesystem::path& folder) {
  CloudJob job{.input = input_of(run, sources, folder),
               .out = folder,
               .params = {},
               .servo = {.level_rad = run.cloud.servo_level_rad},
               .clock_ahead_s = {},
               .lrf = run.scene.lrf,
               .tilt = run.cloud.tilt,
               .speed_max_mps = run.cloud.speed_max_mps,
               .true_mount = {},
               .scans_max = run.scene.scans_max,
               .seed = sources.seed};
  if (!run.scene.world.empty()) {
    job.clock_ahead_s = run.cloud.tilt.clock_ahead_s;
  }
  job.params.robot = run.params;
  job.params.mapping = run.cloud.mapping;
  return job;
}

Table sample_of(const CloudResult& result) {
  Table table{"points", {"x_m", "y_m", "z_m"}, {}};
  if (result.truth) {
    table.columns.emplace_back("distance_to_truth_m");
  }
  const std::size_t step = result.points.size() / kSampleMax + 1;
  for (std::size_t i = 0; i < result.points.size(); i += step) {
    const Point3& p = result.points[i];
    table.rows.push_back({p.x_m, p.y_m, p.z_m});
    if (result.truth) {
      table.rows.back().push_back(result.truth->distances_m[i]);
    }
  }
  return table;
}

}  // namespace

void compute_cloud(const Run& run, const Sources& sources, const std::filesystem::path& folder, const ShareDone& done) {
  const CloudJob job = job_of(run, sources, folder);
  const CloudResult result = run_cloud_job(job, [&done](std::int64_t scans, std::int64_t total, double) {
    done(static_cast<double>(scans) / static_cast<double>(total));
  });
  write_cloud_result(job, result);
  for (int keys = 1; keys <= kKeysApartMax; ++keys) {
    const auto points = points_of_keys(result.run.mapper.cloud(), static_cast<std::size_t>(keys));
    write_cloud_ply(folder / keys_file(keys), points, HeightColours(points));
  }
  write_whole_file(folder / "points.csv", format_csv(sample_of(result)));
}

CloudOutput read_cloud(const std::filesystem::path& folder) {
  const auto summary = nlohmann::json::parse(read_whole_file(folder / "summary.json"));
  CloudOutput output{.points = read_cloud_ply(folder / "cloud.ply"),
                     .trajectory = read_reference_poses(folder / "trajectory.tum").poses,
                     .sample = parse_csv("points", read_whole_file(folder / "points.csv")),
                     .scans_in_cloud = summary["scans_in_cloud"],
                     .scans_without_pose = summary["scans_without_pose"],
                     .floor_height_m = summary["floor_height_m"],
                     .floor_deviation_95_m = summary["floor_deviation_m"]["percentile_95"],
                     .wall_lean_mean_deg = summary["wall_lean_deg"]["mean"],
                     .saw_floor_and_walls = summary["saw_floor_and_walls"]};
  if (const auto truth = summary.find("distance_to_truth_m"); truth != summary.end()) {
    output.distance_median_m = (*truth)["median"];
    output.distance_95_m = (*truth)["percentile_95"];
  }
  return output;
}

std::vector<Point3> read_cloud_of_keys(const std::filesystem::path& folder, int keys) {
  return read_cloud_ply(folder / keys_file(keys));
}

}  // namespace odoless
