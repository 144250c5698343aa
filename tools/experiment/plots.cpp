#include "tools/experiment/plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace odoless {
namespace {

constexpr int kBins = 41;

double normal_density(double value, const RobustNormal& law) {
  const double z = (value - law.mean) / law.deviation;
  return std::exp(-z * z / 2.0) / (law.deviation * std::sqrt(2.0 * std::numbers::pi));
}

Series law_series(const RobustNormal& law, double limit, double per_bin) {
  constexpr int kSteps = 200;
  Series series{fmt::format("normal law, mean {:.3g}, sd {:.3g}", law.mean, law.deviation), Mark::kLine, kRed, {}};
  for (int i = 0; i <= kSteps && law.deviation > 0.0; ++i) {
    const double value = limit * (2.0 * i / kSteps - 1.0);
    series.points.push_back({value, normal_density(value, law) * per_bin});
  }
  return series;
}

std::vector<Point2> points_of(const LogScan& scan, const Pose2& map_T_scan) {
  std::vector<Point2> points;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    if (std::isfinite(range_m) && range_m > 0.0 && scan.ranges_m[i] < scan.no_return_m) {
      const double angle_rad = scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
      points.push_back(map_T_scan * Point2{range_m * std::cos(angle_rad), range_m * std::sin(angle_rad)});
    }
  }
  return points;
}

/// An empty map that holds every point; coarser where they lie so far apart that it would be huge.
OccupancyMap map_around(std::span<const Point2> points, double resolution_m) {
  Point2 low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Point2 high{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
  for (const Point2& point : points) {
    low = {std::min(low.x_m, point.x_m), std::min(low.y_m, point.y_m)};
    high = {std::max(high.x_m, point.x_m), std::max(high.y_m, point.y_m)};
  }
  constexpr double kSideMaxCells = 4000.0;
  resolution_m = std::max({resolution_m, (high.x_m - low.x_m) / kSideMaxCells, (high.y_m - low.y_m) / kSideMaxCells});
  OccupancyMap map{.resolution_m = resolution_m, .origin_x_m = low.x_m, .origin_y_m = low.y_m, .occupancy_percent = {}};
  if (!points.empty()) {
    map.width_cells = static_cast<int>((high.x_m - low.x_m) / resolution_m) + 1;
    map.height_cells = static_cast<int>((high.y_m - low.y_m) / resolution_m) + 1;
  }
  map.occupancy_percent.assign(static_cast<std::size_t>(map.width_cells) * static_cast<std::size_t>(map.height_cells),
                               OccupancyMap::kUnknown);
  return map;
}

}  // namespace

std::vector<Pose2> poses_of(std::span<const ReferencePose> poses) {
  std::vector<Pose2> out;
  for (const ReferencePose& pose : poses) {
    out.push_back(pose.pose);
  }
  return out;
}

Series path_series(const std::string& label, std::span<const Pose2> poses, Rgb rgb) {
  Series series{label, Mark::kLine, rgb, {}};
  for (const Pose2& pose : poses) {
    series.points.push_back({pose.x_m, pose.y_m});
  }
  return series;
}

Series index_series(const std::string& label, std::span<const double> values, double factor, Rgb rgb) {
  Series series{label, Mark::kLine, rgb, {}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    series.points.push_back({static_cast<double>(i), factor * values[i]});
  }
  return series;
}

Chart position_error_panel(std::span<const double> errors_m, std::span<const Arrival> route) {
  std::string places;
  Series visits{"at a place of the route", Mark::kPoints, kRed, {}};
  for (const Arrival& arrival : route) {
    if (arrival.index < errors_m.size()) {
      places += fmt::format("{}{} {}", places.empty() ? "" : ", ", arrival.letter, arrival.index);
      visits.points.push_back({static_cast<double>(arrival.index), 1e3 * errors_m[arrival.index]});
    }
  }
  return {.title = "distance from the true position",
          .x_label = "robot pose (" + places + ")",
          .y_label = "error (mm)",
          .series = {index_series("accumulated error", errors_m, 1e3, kBlue), visits}};
}

OccupancyMap map_of_points(const ScanLog& log, std::span<const Pose2> map_T_scans, double resolution_m) {
  std::vector<Point2> points;
  for (std::size_t i = 0; i < std::min(log.scans.size(), map_T_scans.size()); ++i) {
    for (const Point2& point : points_of(log.scans[i], map_T_scans[i])) {
      points.push_back(point);
    }
  }
  OccupancyMap map = map_around(points, resolution_m);
  for (const Point2& point : points) {
    const auto column = static_cast<std::size_t>((point.x_m - map.origin_x_m) / map.resolution_m);
    const auto row = static_cast<std::size_t>((point.y_m - map.origin_y_m) / map.resolution_m);
    map.occupancy_percent[row * static_cast<std::size_t>(map.width_cells) + column] = 100;
  }
  return map;
}

Chart histogram_panel(const std::string& title, const std::string& x_label, std::span<const double> values,
                      double limit) {
  const double per_bin = 2.0 * limit / kBins;
  std::vector<double> counts(kBins, 0.0);
  for (const double value : values) {
    const double bin = std::floor((value + limit) / per_bin);
    counts[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins - 1)))] += 1.0;
  }
  Series bars{"share of the matches (the outermost bars: and beyond)", Mark::kBars, kBlue, {}};
  for (int i = 0; i < kBins; ++i) {
    const double share =
        counts[static_cast<std::size_t>(i)] / static_cast<double>(std::max<std::size_t>(1, values.size()));
    bars.points.push_back({-limit + (i + 0.5) * per_bin, share});
  }
  const RobustNormal law = fit_normal({values.begin(), values.end()});
  return {.title = title, .x_label = x_label, .y_label = "share", .series = {bars, law_series(law, limit, per_bin)}};
}

Chart fitness_panel(const std::string& title, std::span<const double> fitness) {
  Series values = index_series("A - score, as for 180 beams", fitness, 1.0, kBlue);
  values.mark = Mark::kImpulses;
  const Series threshold{"threshold of the dissertation",
                         Mark::kLine,
                         kRed,
                         {{0.0, kSeedFitnessMax}, {static_cast<double>(fitness.size()), kSeedFitnessMax}}};
  return {.title = title, .x_label = "displacement", .y_label = "fitness", .series = {values, threshold}};
}

Chart map_panel(const std::string& title, const OccupancyMap& map, std::vector<Series> paths) {
  return {.title = title, .x_label = "x (m)", .y_label = "y (m)", .series = std::move(paths), .map = map};
}

}  // namespace odoless
