#include "tools/replay/replay_mcap.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/lcm/messages.hpp"
#include "tools/output/mcap_writer.hpp"
#include "tools/replay/replay_records.hpp"
#include "tools/ros2/cdr.hpp"
#include "tools/ros2/definition.hpp"
#include "tools/ros2/messages.hpp"
#include "tools/ros2/odoless_ros2/include/odoless_ros2/conversion.hpp"

namespace odoless {
namespace {

constexpr double kNsPerS = 1e9;
constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kHealthEvery_ns = 1'000'000'000;
constexpr double kPathStep_m = 0.1;

ros::Frames frames() {
  ros::Frames names;
  names.base = names.laser;  // a replay knows no base
  return names;
}

/// Half a turn about its own x axis, before that.
void roll_over(ros::Quaternion& rotation) {
  std::swap(rotation.w, rotation.x);
  std::swap(rotation.z, rotation.y);
}

}  // namespace

struct ReplayMcap::Parts {
  /// A topic's channel, its message, and the memory of both.
  template <class Message>
  class Topic {
   public:
    Topic(McapWriter& file, const char* name)
        : file_(file), channel_(file.add_channel(name, ros::type_name<Message>(), ros::Definition::of<Message>())) {}

    Message message{};

    void write(std::int64_t stamp_ns) { file_.write(channel_, stamp_ns, encoder_.encode(message)); }

   private:
    McapWriter& file_;
    std::uint16_t channel_;
    ros::CdrWriter encoder_;
  };

  /// Says when what grows with time is written again: the next time after a quarter of the time since the beginning, so
  /// that all of them together are no more than some times the last.
  class GrowingPeriod {
   public:
    [[nodiscard]] bool is_due(std::int64_t stamp_ns) {
      first_ns_ = first_ns_ ? *first_ns_ : stamp_ns;
      if (stamp_ns < next_ns_) {
        return false;
      }
      constexpr std::int64_t kLeast_ns = 2'000'000'000;
      constexpr std::int64_t kShare = 4;
      next_ns_ = stamp_ns + std::max(kLeast_ns, (stamp_ns - *first_ns_) / kShare);
      return true;
    }

   private:
    std::optional<std::int64_t> first_ns_;
    std::int64_t next_ns_ = std::numeric_limits<std::int64_t>::min();
  };

  explicit Parts(const std::filesystem::path& name) : file(name) {}

  void take(const ChainStep& step, const RawScan& raw, StageChain& chain) {
    if (!records) {
      records.emplace(chain.filter());
    }
    records->take(step, raw, chain);
    write_pose(records->pose());
    write_scan(raw);
    write_health(records->health());
    add_to_path(records->pose());
    if (growing.is_due(step.stamp_ns)) {
      write_map(step.stamp_ns);
      write_path(step.stamp_ns);
    }
    last_ns = std::max(last_ns, step.stamp_ns);
  }

  /// Of the laser, as scans are: a replay's frames end there.
  void write_pose(const PoseRecord& record) {
    PoseRecord of_laser = record;
    of_laser.laser = {};
    of_laser.map_T_scan.yaw_rad = wrap_angle(record.map_T_scan.yaw_rad + record.laser.yaw_rad);
    to_message(of_laser, estimate);
    ros::to_ros(estimate, record.map_T_odom, names, transforms.message);
    ros::to_ros(estimate, names, pose.message);
    if (record.laser.is_flipped) {
      roll_over(transforms.message.transforms[1].transform.rotation);
      roll_over(pose.message.pose.pose.orientation);
    }
    transforms.write(record.stamp_ns);
    pose.write(record.stamp_ns);
  }

  void write_scan(const RawScan& raw) {
    to_message(ReplayRecords::scan(raw), raw.ranges_m, lidar);
    const double beam_period_s = static_cast<double>(raw.beam_period_ns) / kNsPerS;
    const double since_s = static_cast<double>(raw.stamp_ns - last_ns) / kNsPerS;
    ros::to_ros(
        lidar,
        {.beam_period_s = beam_period_s, .scan_period_s = last_ns > 0 ? since_s : 0.0, .range_max_m = raw.no_return_m},
        names, scan.message);
    scan.write(raw.stamp_ns);
  }

  void write_health(const HealthReport& report) {
    if (report.state != told_state || report.reasons != told_reasons || report.stamp_ns >= told_ns + kHealthEvery_ns) {
      told_state = report.state;
      told_reasons = report.reasons;
      told_ns = report.stamp_ns;
      to_message(report, health);
      ros::to_ros(health, diagnostics.message);
      diagnostics.write(report.stamp_ns);
    }
  }

  void add_to_path(const PoseRecord& record) {
    if (path_so_far.empty() || path_so_far.back().map_T_scan.distance_m(record.map_T_scan) >= kPathStep_m) {
      path_so_far.push_back({record.stamp_ns, record.map_T_scan});
    }
  }

  void write_map(std::int64_t stamp_ns) {
    const MapView view = records->map().view(stamp_ns);
    if (!view.cells.empty()) {
      write_map({.utime = stamp_ns / kNsPerUs,
                 .lower_left_x_m = view.lower_left_x_m,
                 .lower_left_y_m = view.lower_left_y_m,
                 .cell_size_m = view.cell_size_m,
                 .columns = static_cast<std::uint32_t>(view.columns),
                 .rows = static_cast<std::uint32_t>(view.rows)},
                view.cells);
    }
  }

  void write_map(const ros::GridExtent& extent, std::span<const std::uint8_t> cells) {
    ros::to_ros(extent, cells, names, map.message);
    map.write(extent.utime * kNsPerUs);
  }

  void write_path(std::int64_t stamp_ns) {
    ros::set_header(stamp_ns / kNsPerUs, names.map, path.message.header);
    path.message.poses.resize(path_so_far.size());
    for (std::size_t i = 0; i < path_so_far.size(); ++i) {
      ros::set_header(path_so_far[i].stamp_ns / kNsPerUs, names.map, path.message.poses[i].header);
      ros::set_pose(path_so_far[i].map_T_scan, path.message.poses[i].pose);
    }
    path.write(stamp_ns);
  }

  McapWriter file;
  const ros::Frames names = frames();
  Topic<ros::LaserScan> scan{file, "/scan"};
  Topic<ros::TFMessage> transforms{file, "/tf"};
  Topic<ros::PoseWithCovarianceStamped> pose{file, "/pose"};
  Topic<ros::DiagnosticArray> diagnostics{file, "/diagnostics"};
  Topic<ros::OccupancyGrid> map{file, "/map"};
  Topic<ros::Path> path{file, "/path"};
  std::optional<ReplayRecords> records;  ///< from the first scan on
  std::vector<StampedPose> path_so_far;
  GrowingPeriod growing;
  std::int64_t last_ns = 0;
  std::int64_t told_ns = 0;
  HealthState told_state = HealthState::kInit;
  std::uint32_t told_reasons = 0;
  bot_core::planar_lidar_t lidar{};
  pose_estimate_t estimate{};
  health_t health{};
};

ReplayMcap::ReplayMcap(const std::filesystem::path& file) : parts_(std::make_unique<Parts>(file)) {}

ReplayMcap::~ReplayMcap() = default;

ReplayWatcher ReplayMcap::watcher() {
  return [this](const ChainStep& step, const RawScan& raw, StageChain& chain) { parts_->take(step, raw, chain); };
}

void ReplayMcap::finish(const ReplayResult& result) {
  const OccupancyMap& map = result.map;
  if (!map.occupancy_percent.empty()) {
    std::vector<std::uint8_t> cells(map.occupancy_percent.size());
    std::transform(map.occupancy_percent.begin(), map.occupancy_percent.end(), cells.begin(),
                   [](std::int8_t percent) { return static_cast<std::uint8_t>(percent); });  // unknown: 255
    parts_->write_map({.utime = parts_->last_ns / kNsPerUs,
                       .lower_left_x_m = map.origin_x_m,
                       .lower_left_y_m = map.origin_y_m,
                       .cell_size_m = map.resolution_m,
                       .columns = static_cast<std::uint32_t>(map.width_cells),
                       .rows = static_cast<std::uint32_t>(map.height_cells)},
                      cells);
  }
  parts_->path_so_far = result.trajectory;
  parts_->write_path(parts_->last_ns);
  parts_->file.finish();
}

}  // namespace odoless
