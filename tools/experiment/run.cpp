#include "tools/experiment/run.hpp"

#include <fmt/format.h>

#include "config/config.hpp"
#include "tools/experiment/cloud_output.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/sha256.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/replay/replay.hpp"

namespace odoless {
namespace {

constexpr const char* kKeyFile = "key.txt";

std::int64_t estimate_scans(const Scene& scene) {
  constexpr std::int64_t kSimulated = 366;
  constexpr std::int64_t kRecorded = 5000;
  const std::int64_t scans = scene.world.empty() ? kRecorded : kSimulated;
  return scene.scans_max > 0 ? std::min(scene.scans_max, scans) : scans;
}

/// The program is an input as well: another build may give other results.
const std::string& program_digest() {
  static const std::string digest = sha256_of_file("/proc/self/exe");
  return digest;
}

void compute_pairs(const Run& run, const ScanLog& log, const ReplayOptions& options,
                   const std::filesystem::path& folder, const ReplayProgress& progress) {
  write_matches(folder / "matches.csv", match_pairs(log, run.params, options, progress));
}

void compute_mapping(const Run& run, const ScanLog& log, const ReplayOptions& options,
                     const std::filesystem::path& folder, const ReplayProgress& progress) {
  const ReplayResult result = replay(log, run.params, options, progress);
  write_matches(folder / "matches.csv", result.matches);
  write_trajectory(folder / "trajectory.tum", result.trajectory);
  write_map(folder, result.map);
}

const char* name_of(Run::Kind kind) {
  return kind == Run::Kind::kPairs ? "pairs" : kind == Run::Kind::kMapping ? "mapping" : "cloud";
}

std::string cloud_key(const CloudSetting& cloud) {
  return fmt::format("speed {} level {}\n{}{}", cloud.speed_max_mps, cloud.servo_level_rad, write_toml(cloud.tilt),
                     write_toml(cloud.mapping));
}

}  // namespace

double estimate_cost_s(const Run& run) {
  if (run.kind == Run::Kind::kCloud) {
    constexpr double kCloudS = 8.0;
    return kCloudS;
  }
  const auto scans = static_cast<double>(estimate_scans(run.scene)) / run.every;
  if (run.kind == Run::Kind::kMapping) {
    constexpr double kPerScanS = 3e-3;
    constexpr double kPerParticleS = 4e-5;
    return scans * (kPerScanS + kPerParticleS * (run.params.slam.low.particles + run.params.slam.high.particles));
  }
  const SearchParams& search = run.params.matcher.search;
  constexpr double kPerExactEvaluationS = 3e-6;
  return scans * (1e-3 + (search.exact ? kPerExactEvaluationS * search.fine_evaluations : 0.0));
}

std::string run_key(const Run& run, const Sources& sources) {
  return fmt::format("program {}\n{} every {}\n{}{}{}", program_digest(), name_of(run.kind), run.every,
                     scene_key(run.scene, sources), write_toml(run.params),
                     run.kind == Run::Kind::kCloud ? cloud_key(run.cloud) : "");
}

bool is_finished(const std::filesystem::path& folder, const std::string& key) {
  return std::filesystem::exists(folder / kKeyFile) && read_whole_file(folder / kKeyFile) == key;
}

void mark_finished(const std::filesystem::path& folder, const std::string& key) {
  write_whole_file(folder / kKeyFile, key);
}

void compute_run(const Run& run, const Sources& sources, const std::filesystem::path& folder, const ShareDone& done) {
  make_output_folder(folder);
  if (run.kind == Run::Kind::kCloud) {
    return compute_cloud(run, sources, folder, done);
  }
  const SceneData scene = load_scene(run.scene, sources);
  const ReplayOptions options{.every = run.every, .seed = sources.seed};
  const ReplayProgress progress = [&](std::int64_t scans, std::int64_t total, double) {
    done(static_cast<double>(scans) / static_cast<double>(total));
  };
  const auto compute = run.kind == Run::Kind::kPairs ? compute_pairs : compute_mapping;
  compute(run, scene.log, options, folder, progress);
}

RunOutput read_run(const Run& run, const std::filesystem::path& folder) {
  RunOutput output{read_matches(folder / "matches.csv"), {}, {}};
  if (run.kind == Run::Kind::kMapping) {
    output.trajectory = read_reference_poses(folder / "trajectory.tum").poses;
    output.map = read_map(folder);
  }
  return output;
}

}  // namespace odoless
