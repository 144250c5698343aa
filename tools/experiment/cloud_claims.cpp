#include "tools/experiment/cloud_claims.hpp"

#include <fmt/format.h>

namespace odoless {

Claim projects_onto_surfaces(const std::string& figure, const std::string& stated, const CloudOutput& output) {
  constexpr double kMedianMaxM = 0.020;
  constexpr double k95MaxM = 0.060;
  return {figure, stated,
          fmt::format("{} points: median {:.1f} mm from the true surfaces, 95 % within {:.1f} mm", output.points.size(),
                      output.distance_median_m * 1e3, output.distance_95_m * 1e3),
          !output.points.empty() && output.distance_median_m <= kMedianMaxM && output.distance_95_m <= k95MaxM};
}

Claim floor_is_flat(const std::string& figure, const CloudOutput& output) {
  constexpr double kDeviationMaxM = 0.020;
  return {figure, "our aim: the floor is flat within 20 mm",
          fmt::format("95 % of its points within {:.1f} mm of its middle height; walls lean by {:.2f} deg on average",
                      output.floor_deviation_95_m * 1e3, output.wall_lean_mean_deg),
          output.saw_floor_and_walls && output.floor_deviation_95_m <= kDeviationMaxM};
}

Claim most_scans_are_mapped(const std::string& figure, const std::string& stated, const CloudOutput& output) {
  constexpr double kMost = 0.75;
  const int scans = output.scans_in_cloud + output.scans_without_pose;
  return {figure, stated,
          fmt::format("{} of {} scans mapped, {} points; of the others the pose was not known well enough",
                      output.scans_in_cloud, scans, output.points.size()),
          scans > 0 && output.scans_in_cloud >= kMost * scans};
}

}  // namespace odoless
