#include "firmware/web/live_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/math/elementary.hpp"
#include "firmware/lcm/map_view.hpp"
#include "firmware/records/robot_pose.hpp"
#include "firmware/threads/tile_sweep.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr int kSide_cells = TileSweep::kSide_cells;
constexpr std::size_t kTileCells = std::size_t{kSide_cells} * kSide_cells;
constexpr std::uint8_t kUnknownLevel = 16;
constexpr std::size_t kScanPoints = 240;
constexpr std::int64_t kScanEvery_ns = 180'000'000;
constexpr std::int64_t kStateEvery_ns = 500'000'000;
constexpr std::size_t kTrailPoints = 256;  // in one event

// That the filter's grid touches, wherever it lies.
int tiles_across(int cells) { return (cells + kSide_cells - 1) / kSide_cells + 1; }

std::size_t place(int at, int most) { return static_cast<std::size_t>(at % most + (at % most < 0 ? most : 0)); }

int centimetres(double length_m) { return static_cast<int>(std::lround(length_m * 100.0)); }

// Of points: "1,2,3,4", in centimetres.
void append_points(std::span<const Point2> points, std::string& text) {
  for (const Point2& point : points) {
    fmt::format_to(std::back_inserter(text), "{}{},{}", &point == points.data() ? "" : ",", centimetres(point.x_m),
                   centimetres(point.y_m));
  }
}

}  // namespace

std::uint8_t level_of(std::uint8_t percent) {
  return percent == kUnknownCell ? kUnknownLevel
                                 : static_cast<std::uint8_t>((std::min<int>(percent, 100) * 15 + 50) / 100);
}

void append_runs(std::span<const std::uint8_t> levels, std::string& text) {
  for (std::size_t i = 0; i < levels.size();) {
    std::size_t end = i + 1;
    while (end < levels.size() && levels[end] == levels[i]) {
      ++end;
    }
    text += static_cast<char>('a' + levels[i]);
    if (end - i > 1) {
      fmt::format_to(std::back_inserter(text), "{}", end - i);
    }
    i = end;
  }
}

LiveView::LiveView(const GridGeometry& geometry)
    : run_(fmt::format("{:x}", monotonic_ns())),
      cell_size_m_(geometry.resolution_m),
      tile_columns_(tiles_across(geometry.columns)),
      tile_rows_(tiles_across(geometry.rows)),
      tiles_(static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows_)),
      versions_(tiles_.size()),
      levels_(versions_.size() * kTileCells, kUnknownLevel) {
  scan_p_map_.reserve(kScanPoints);
}

std::span<std::uint8_t> LiveView::levels_of(std::size_t tile) {
  return std::span(levels_).subspan(tile * kTileCells, kTileCells);
}

void LiveView::clear_map(int map_number) {
  map_number_ = map_number;
  std::fill(versions_.begin(), versions_.end(), 0);
  std::fill(levels_.begin(), levels_.end(), kUnknownLevel);
  trail_.clear();
}

void LiveView::take(const PoseRecord& pose) {
  const std::lock_guard lock(mutex_);
  if (pose.map_number != map_number_) {
    clear_map(pose.map_number);
  }
  pose_ = pose;
  ++poses_;
  const Pose2 map_T_robot = robot_pose_of(pose).map_T_robot;
  trail_.add({map_T_robot.x_m, map_T_robot.y_m});
}

void LiveView::take(const MapTileRecord& tile, std::span<const std::uint8_t> cells) {
  if (cells.size() != kTileCells) {
    return;
  }
  const std::size_t index =
      place(tile.row, tile_rows_) * static_cast<std::size_t>(tile_columns_) + place(tile.column, tile_columns_);
  std::array<std::uint8_t, kTileCells> levels{};
  std::transform(cells.begin(), cells.end(), levels.begin(), level_of);
  const std::lock_guard lock(mutex_);
  const std::span<std::uint8_t> known = levels_of(index);
  const bool is_other = tiles_[index].column != tile.column || tiles_[index].row != tile.row;
  if (is_other || !std::equal(known.begin(), known.end(), levels.begin())) {
    tiles_[index] = {tile.column, tile.row};
    std::copy(levels.begin(), levels.end(), known.begin());
    versions_[index] = ++version_;
  }
}

void LiveView::take(const DaemonStatus& status) {
  const std::lock_guard lock(mutex_);
  status_ = status;
}

void LiveView::take(const PoseRecord& pose, const ScanRecord& scan, std::span<const float> ranges_m) {
  if (scan.stamp_ns - scan_stamp_ns_ < kScanEvery_ns) {
    return;
  }
  const std::lock_guard lock(mutex_);
  scan_stamp_ns_ = scan.stamp_ns;
  ++scans_;
  scan_p_map_.clear();
  const std::size_t step = ranges_m.size() / kScanPoints + 1;
  for (std::size_t i = 0; i < ranges_m.size(); i += step) {
    const auto range_m = static_cast<double>(ranges_m[i]);
    if (std::isfinite(range_m) && range_m > 0.0) {
      const double bearing_rad =
          pose.laser.bearing_rad(scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad);
      scan_p_map_.push_back(pose.map_T_scan *
                            Point2{range_m * math::cos(bearing_rad), range_m * math::sin(bearing_rad)});
    }
  }
}

void LiveView::tell(LiveCursor& cursor, std::int64_t now_ns, std::string& events) const {
  constexpr double kMostCredit_s = 0.1;
  const double since_s = cursor.last_ns == 0 ? kMostCredit_s : static_cast<double>(now_ns - cursor.last_ns) * 1e-9;
  cursor.last_ns = now_ns;
  cursor.credit_bytes = std::min(cursor.credit_bytes + since_s * kRate_bytes_per_s, kMostCredit_s * kRate_bytes_per_s);
  const std::size_t before_bytes = events.size();
  const auto is_paid = [&] { return static_cast<double>(events.size() - before_bytes) < cursor.credit_bytes; };
  tell_beginning(cursor, events);
  tell_state(cursor, now_ns, events);
  if (is_paid()) {
    tell_pose(cursor, events);
    tell_scan(cursor, events);
  }
  while (is_paid() && tell_tile(cursor, events)) {
  }
  cursor.credit_bytes -= static_cast<double>(events.size() - before_bytes);
}

void LiveView::tell_beginning(LiveCursor& cursor, std::string& events) const {
  const std::lock_guard lock(mutex_);
  if (cursor.map_number != map_number_) {
    cursor.map_number = map_number_;
    fmt::format_to(
        std::back_inserter(events),
        "retry: 500\nevent: map\ndata: {{\"run\":\"{}\",\"number\":{},\"side_cells\":{},\"cell_size_m\":{}}}\n\n", run_,
        map_number_, kSide_cells, cell_size_m_);
  }
}

void LiveView::tell_state(LiveCursor& cursor, std::int64_t now_ns, std::string& events) const {
  std::optional<DaemonStatus> status;
  {
    const std::lock_guard lock(mutex_);
    status = status_;
  }
  if (!status) {
    return;
  }
  const std::uint32_t mark = (status->health.reasons << 3U) + static_cast<std::uint32_t>(status->health.state);
  if (cursor.state_ns == 0 || mark != cursor.state_mark || now_ns - cursor.state_ns >= kStateEvery_ns) {
    cursor.state_mark = mark;
    cursor.state_ns = now_ns;
    events += "event: state\ndata: " + status_json(*status).dump() + "\n\n";
  }
}

void LiveView::tell_pose(LiveCursor& cursor, std::string& events) const {
  const std::lock_guard lock(mutex_);
  if (!pose_ || cursor.pose == poses_) {
    return;
  }
  cursor.pose = poses_;
  const auto& [map_T_robot, step, covariance] = robot_pose_of(*pose_);
  fmt::format_to(std::back_inserter(events),
                 "event: pose\ndata: {{\"stamp_s\":{:.3f},\"x_m\":{:.3f},\"y_m\":{:.3f},\"yaw_rad\":{:.4f},"
                 "\"covariance_m2\":[{:.6f},{:.6f},{:.6f}],\"sd_yaw_rad\":{:.4f}}}\n\n",
                 static_cast<double>(pose_->stamp_ns) * 1e-9, map_T_robot.x_m, map_T_robot.y_m, map_T_robot.yaw_rad,
                 covariance[0], covariance[1], covariance[4], std::sqrt(covariance[8]));
  if (const auto points = trail_.next(cursor.trail, kTrailPoints); !points.empty()) {
    fmt::format_to(std::back_inserter(events), "event: path\ndata: {{\"from\":{},\"points_cm\":[",
                   cursor.trail.points - points.size());
    append_points(points, events);
    events += "]}\n\n";
  }
}

void LiveView::tell_scan(LiveCursor& cursor, std::string& events) const {
  const std::lock_guard lock(mutex_);
  if (cursor.scan == scans_) {
    return;
  }
  cursor.scan = scans_;
  events += "event: scan\ndata: {\"points_cm\":[";
  append_points(scan_p_map_, events);
  events += "]}\n\n";
}

bool LiveView::tell_tile(LiveCursor& cursor, std::string& events) const {
  std::array<std::uint8_t, kTileCells> levels{};
  std::size_t index = versions_.size();
  TileIndex tile;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < versions_.size(); ++i) {  // the one that changed longest ago
      const bool is_new = versions_[i] > cursor.tile;
      index = is_new && (index == versions_.size() || versions_[i] < versions_[index]) ? i : index;
    }
    if (index == versions_.size()) {
      return false;
    }
    cursor.tile = versions_[index];
    tile = tiles_[index];
    const auto first = levels_.begin() + static_cast<std::ptrdiff_t>(index * kTileCells);
    std::copy(first, first + static_cast<std::ptrdiff_t>(kTileCells), levels.begin());
  }
  fmt::format_to(std::back_inserter(events), "event: tile\ndata: {} {} ", tile.column, tile.row);
  append_runs(levels, events);
  events += "\n\n";
  return true;
}

}  // namespace odoless
