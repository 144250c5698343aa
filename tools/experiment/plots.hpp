#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/grid/occupancy_map.hpp"
#include "tools/experiment/figure.hpp"
#include "tools/experiment/measures.hpp"
#include "tools/experiment/route.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// Kinds of plots that several experiments draw.

[[nodiscard]] Series path_series(const std::string& label, std::span<const Pose2> poses, Rgb rgb);
[[nodiscard]] std::vector<Pose2> poses_of(std::span<const ReferencePose> poses);

/// Values over their index.
[[nodiscard]] Series index_series(const std::string& label, std::span<const double> values, double factor, Rgb rgb);

/// Accumulated error of position over the pose number, with the route's places on the axis' label.
[[nodiscard]] Chart position_error_panel(std::span<const double> errors_m, std::span<const Arrival> route);

/// Where the scans' returns lie when they are taken from these poses: occupied cells, all else unknown.
[[nodiscard]] OccupancyMap map_of_points(const ScanLog& log, std::span<const Pose2> map_T_scans, double resolution_m);

/// How often errors fall into each of some bins between -limit and +limit, as shares, beside a fitted normal law.
[[nodiscard]] Chart histogram_panel(const std::string& title, const std::string& x_label,
                                    std::span<const double> values, double limit);

/// Fitness of each match, in the dissertation's form (self_fitness.hpp), beneath its threshold.
[[nodiscard]] Chart fitness_panel(const std::string& title, std::span<const double> fitness);

/// A map with paths over it.
[[nodiscard]] Chart map_panel(const std::string& title, const OccupancyMap& map, std::vector<Series> paths);

constexpr double kSeedFitnessMax = 30.0;  ///< section 5.1.3: below, a match has very likely converged

}  // namespace odoless
