#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tools/log/reference_poses.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/sim/simulated_lrf.hpp"

namespace odoless {

/// Where an experiment's scans come from: a built-in world that a simulated laser is driven through, or a recorded log.
struct Scene {
  std::string world{};         ///< built-in world file; empty: recorded
  SimulatedLrfParams lrf{};    ///< of a simulated scene
  std::string log{};           ///< of a recorded scene: file in the data folder
  std::string reference{};     ///< of a recorded scene: file with reference poses, in the same folder; empty: none
  std::string relations{};     ///< of a recorded scene: file with verified motions; empty: none
  std::int64_t scans_max = 0;  ///< the first so many scans; 0: all
};

/// What all experiments of a call have in common.
struct Sources {
  std::filesystem::path data{};  ///< folder of recorded logs
  std::uint64_t seed = 1;        ///< of the simulated noise and of the method
};

struct SceneData {
  ScanLog log;
  ReferencePoses truth;  ///< empty where there is none
};

/// The file that is needed and absent, or an empty text.
[[nodiscard]] std::string missing_file(const Scene& scene, const Sources& sources);

/// Simulates or reads the scans. @throws what reading a log or a reference throws.
[[nodiscard]] SceneData load_scene(const Scene& scene, const Sources& sources);

/// All that the scans depend on, as a text that changes when they do.
[[nodiscard]] std::string scene_key(const Scene& scene, const Sources& sources);

}  // namespace odoless
