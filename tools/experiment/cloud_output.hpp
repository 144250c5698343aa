#pragma once

#include <filesystem>
#include <vector>

#include "core/geometry/pose3.hpp"
#include "tools/experiment/run.hpp"
#include "tools/experiment/table.hpp"

namespace odoless {

/// What a run in 3D left behind, read back from its files.
struct CloudOutput {
  std::vector<Point3> points{};             ///< of the map
  std::vector<ReferencePose> trajectory{};  ///< of the level scans
  Table sample{};                           ///< every n-th point; of a simulated run with its distance to the truth
  /// The summary's figures (tools/cloud).
  int scans_in_cloud = 0;
  int scans_without_pose = 0;
  double floor_height_m = 0.0;
  double floor_deviation_95_m = 0.0;
  double wall_lean_mean_deg = 0.0;
  bool saw_floor_and_walls = false;
  double distance_median_m = 0.0;  ///< to the truth; of a simulated run
  double distance_95_m = 0.0;
};

/// Makes a 3D map of the run's scene and writes all that `odoless cloud` does into `folder`, points.csv, and the points
/// of the first key poses alone.
void compute_cloud(const Run& run, const Sources& sources, const std::filesystem::path& folder, const ShareDone& done);

[[nodiscard]] CloudOutput read_cloud(const std::filesystem::path& folder);
/// What was seen from the first so many key poses; 1 to kKeysApartMax.
[[nodiscard]] std::vector<Point3> read_cloud_of_keys(const std::filesystem::path& folder, int keys);
constexpr int kKeysApartMax = 4;

}  // namespace odoless
