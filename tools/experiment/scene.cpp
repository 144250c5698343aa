#include "tools/experiment/scene.hpp"

#include <fmt/format.h>

#include "config/config.hpp"
#include "tools/experiment/builtin_files.hpp"
#include "tools/output/sha256.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

ReferencePoses true_poses(const Simulation& simulation, const std::string& name) {
  LineReader lines(view_bytes(simulation.truth, name), name);
  return read_reference_poses(lines);
}

SceneData simulate_scene(const Scene& scene, std::uint64_t seed) {
  const World world = parse_world(builtin_file(scene.world), scene.world);
  const Simulation simulation = simulate(world, scene.lrf, seed);
  LineReader lines(view_bytes(simulation.log, scene.world), scene.world);
  return {read_scan_log(lines), true_poses(simulation, scene.world)};
}

SceneData read_scene(const Scene& scene, const std::filesystem::path& data) {
  SceneData read{read_scan_log(data / scene.log), {}};
  if (!scene.reference.empty()) {
    read.truth = read_reference_poses(data / scene.reference);
  }
  return read;
}

}  // namespace

std::string missing_file(const Scene& scene, const Sources& sources) {
  for (const std::string& name : {scene.log, scene.reference, scene.relations}) {
    if (!name.empty() && !std::filesystem::exists(sources.data / name)) {
      return name;
    }
  }
  return {};
}

SceneData load_scene(const Scene& scene, const Sources& sources) {
  SceneData data = scene.world.empty() ? read_scene(scene, sources.data) : simulate_scene(scene, sources.seed);
  const auto scans_max = static_cast<std::size_t>(scene.scans_max);
  if (scans_max > 0 && data.log.scans.size() > scans_max) {
    data.log.scans.resize(scans_max);
  }
  return data;
}

std::string scene_key(const Scene& scene, const Sources& sources) {
  std::string key = fmt::format("seed {}\nscans_max {}\n", sources.seed, scene.scans_max);
  if (!scene.world.empty()) {
    return key + write_toml(scene.lrf) + std::string(builtin_file(scene.world));
  }
  for (const std::string& name : {scene.log, scene.reference, scene.relations}) {
    key += name.empty() ? "" : fmt::format("{} {}\n", name, sha256_of_file(sources.data / name));
  }
  return key;
}

}  // namespace odoless
